// Defines the report of a step: times by phase, iterations, the decrease reached, and why it ended.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "base/names.h"
#include "base/types.h"
#include "base/unsolved_step.h"
#include "sim/model/budget_cuts.h"

namespace supple {

// Counts contacts and their changes.
struct ContactCounts {
  int touching = 0;  // contacts in force at the end: a point counts for each collider and part that it touches
  int changes = 0;   // touching points that came or went, over all iterations
  int cycles = 0;    // iterations that came back to the touching points of the one before last
};

enum class StopReason { iterations, round_off, target_error, still, line_search_failed, budget };
template <>
struct Names<StopReason> {
  static constexpr std::array table = {Name{StopReason::iterations, "iterations"},
                                       Name{StopReason::round_off, "round-off"},
                                       Name{StopReason::target_error, "target error"},
                                       Name{StopReason::still, "still"},
                                       Name{StopReason::line_search_failed, "line search failed"},
                                       Name{StopReason::budget, "budget"}};
};

struct StepFailure {
  std::string during;  // part of the step, such as "line search"
  int vertex = -1;     // the vertex furthest out, as numbered in the input file
  std::string what;    // such as "a number is no longer finite"
};

// Describes one iteration in detail. alpha = 0 marks a new start from where the body was.
struct IterationRecord {
  double elapsed_ms = 0;     // since the step was entered
  double decrease = 0;       // of g [J]
  double alpha = 1;          // length of the step along the direction
  struct Full {              // of the full step, alpha = 1
    bool decreases = true;   // as Armijo's test asks
    double slope_ratio = 0;  // slope there over slope at the iterate
  } full;
};

struct StepReport {
  double step_ms = 0;      // entry to return
  double evaluate_ms = 0;  // energies and gradients
  double solve_ms = 0;     // A d = r
  double lbfgs_ms = 0;     // recursions
  double collide_ms = 0;   // finding contacts; 0 where there is nothing to touch
  double matrix_ms = 0;    // renewing the matrix of directions; 0 in most steps
  double other_ms = 0;     // the rest; the six add up to step_ms
  double start_ms = 0;     // until the first iterate was evaluated
  int iterations = 0;
  int newton_iterations = 0;             // iterations of Newton's method that finished a hard step
  int line_search = 0;                   // trial evaluations
  std::vector<double> objective;         // g by iteration, the start first; reserved by the workspace [J]
  std::vector<IterationRecord> records;  // by iteration
  double decrease = 0;                   // g(start) - g(end), summed without cancellation [J]
  double remaining_estimate = 0;         // g(end) - g*, from the decrement or from how decreases shrank [J]
  double error_estimate = 0;             // of equation 12's error, from remaining_estimate
  double motion_estimate = 0;            // of the error of motion (motion_error.h), by two forecasts
  double motion_ahead = 0;               // the same by the way ahead alone
  std::vector<double> motion_estimates;  // the same of each part; empty for a model of one
  double slope = 0;                      // tr(grad^T d) of the last direction [J]
  double decrement = 0;                  // half of |slope| at the end: what a quadratic g would still lose [J]
  StopReason stop_reason = StopReason::iterations;
  BudgetCuts cuts;  // where a budget of time ended the iterations
  ContactCounts contacts;
  Vec3 contact_force = Vec3(0, 0, 0);  // of all that touches the body, at the end of the step [N]
  std::vector<Vec3> collider_forces;   // force of each collider on the body; empty without colliders [N]
  bool failed = false;
  StepFailure failure;
};

// Tells whether a step did not come near its minimum. Where Newton's method finished it, or nothing is left to go, the
// estimates alone count: line searches that tried many points only tell that the iterations before were hard.
inline bool is_unsolved(const StepReport& report) {
  const bool is_certain = report.newton_iterations > 0 || report.stop_reason == StopReason::still;
  return is_unsolved(std::max(report.error_estimate, report.motion_estimate), report.iterations,
                     is_certain ? 0 : report.line_search);
}

}  // namespace supple
