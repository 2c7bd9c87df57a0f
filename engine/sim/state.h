// What changes while a body moves, and what comes from outside to move it.
#pragma once

#include <string>
#include <vector>

#include "sim/contact.h"

namespace supple {

// All that a body's future depends on. A copy is a snapshot.
struct State {
  Positions x;      // positions, n x 3, in the model's order [m]
  Positions v;      // velocities, n x 3 [m/s]
  double time = 0;  // [s]
};

// The model at rest where it was built.
State rest_state(const Model& model);

// XXH64 of all positions, then all velocities, as little-endian doubles in the order of the input file.
std::uint64_t state_hash(const Model& model, const State& state);

// Rows of the input file's order.
Positions in_input_order(const Model& model, const Positions& internal);

enum class LineSearch { armijo, wolfe, none };
const char* text_of(LineSearch search);  // as scene files spell it

// Settings that may change between steps.
struct SolverSettings {
  int iterations = 10;
  int history = 5;  // window m of L-BFGS; 0 is plain quasi-Newton
  LineSearch line_search = LineSearch::armijo;
  double armijo = 0.3;      // gamma
  double target_error = 0;  // stop when the error estimate falls below; 0: do all iterations
  ContactSettings contact;
};

// All that comes from outside for one step of one body.
struct FrameInputs {
  Vec3 gravity = Vec3(0, -9.81, 0);  // [m/s^2]
  Positions targets;                 // at the end of the step, by Model::handled [m]
  Positions middle_targets;          // at its middle; only for implicit midpoint [m]
  SolverSettings solver;
  const std::vector<Collider>* colliders = nullptr;   // null or empty: nothing to touch, and nothing is paid for it
  std::vector<ColliderMotion> collider_motions = {};  // of each over the step
};

enum class StopReason { iterations, round_off, target_error, line_search_failed };
const char* text_of(StopReason reason);

struct StepFailure {
  std::string phase;
  int vertex = -1;   // of the input file
  std::string what;  // "the position is not finite"
};

// One iteration, for who looks closer; or, with alpha = 0, a new start from where the body was.
struct IterationRecord {
  double elapsed_ms = 0;     // since the step was entered
  double decrease = 0;       // of g [J]
  double alpha = 1;          // step length
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
  double collide_ms = 0;   // finding contacts; 0 without colliders
  double other_ms = 0;     // the rest; the five add up to step_ms
  double start_ms = 0;     // until the first iterate was evaluated
  int iterations = 0;
  int line_search = 0;                   // trial evaluations
  std::vector<double> objective;         // g by iteration, the start first; reserved by the workspace [J]
  std::vector<IterationRecord> history;  // by iteration
  double decrease = 0;                   // g(start) - g(end), summed without cancellation [J]
  double remaining_estimate = 0;         // g(end) - g*, continuing the decreases as they shrank [J]
  double error_estimate = 0;             // of equation 12, from that
  double slope = 0;                      // tr(grad^T d) of the last direction [J]
  StopReason stop_reason = StopReason::iterations;
  ContactCounts contacts;
  Vec3 contact_force = Vec3::Zero();  // of all colliders on the body, at the end of the step [N]
  bool failed = false;
  StepFailure failure;
};

}  // namespace supple
