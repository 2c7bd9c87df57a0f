// Compares solvers on one state: how long they take, and how close to the minimum they come. Everything is measured
// within one run, from the same state and with the same threads.
#pragma once

#include <optional>

#include "app/bench/subject.h"
#include "baselines/make_rule.h"
#include "baselines/reference.h"

namespace supple {

using RuleMaker = std::unique_ptr<SearchRule> (*)(const Model&);

// Describes a solver in a comparison, with its settings.
struct SolverEntry {
  std::string label;
  Method method = Method::quasi_newton;
  int iterations = 10;
  int history = 5;
  ChebyshevSettings chebyshev = {};
  DirectionStart start = {};  // where directions of quasi-Newton start
  RuleMaker maker = nullptr;  // makes a rule that takes the method's place (baselines/figure_rules.h)
};

// Holds the result of one solver on one state. Lists go by iteration, with the first iterate first.
struct Outcome {
  std::string label;
  std::vector<double> gained;  // g(y) - g(x_k) [J]
  std::vector<double> ms;      // time since the step was entered, the least of all timed runs
  std::vector<IterationRecord> records;
  double step_ms = 0, median_ms = 0;               // time of the whole step, least and median
  double overhead_ms = 0;                          // time of L-BFGS without its solve
  double matrix_ms = 0;                            // least time of making the matrix, which is contained in `ms`
  double error_estimate = 0, motion_estimate = 0;  // the solver's own estimates
  int iterations = 0, trials = 0;
  bool failed = false;
  StopReason stop_reason = StopReason::iterations;
  Positions x;
  std::vector<Eigen::MatrixX3f> moved;   // iterates less the positions before the step [m]
  std::vector<double> steps, overheads;  // of each timed run [ms]
  double used_ms = 0;                    // time of all runs
};

// This is thrown between two runs when a signal has asked the program to end.
struct BenchInterrupted {};

// Keeps the prepared solvers of one subject. Patterns and constant factors are computed once, outside of the measured
// time.
class SolverComparison {
 public:
  // Both arguments must outlive this object.
  SolverComparison(Subject& subject, Threads& threads)
      : subject_(subject), lowest_(subject.model()), prepared_for_(subject.model().id) {
    workspace_.threads = reference_workspace_.threads = &threads;
  }

  // Runs every solver `repeats` times (at least once) from the state, after one run that is not timed. The solvers take
  // turns. budget_ms: a solver that has used more than this time is not repeated any more [ms].
  std::vector<Outcome> run(const BenchState& state, const std::vector<SolverEntry>& entries, int repeats,
                           double budget_ms = 4000);

  // Returns y of the step, in the model's order [m].
  Positions prediction(const BenchState& state);

  // Evaluates the error of motion for each iteration. solved: the minimum [m].
  std::vector<double> motion_errors(const BenchState& state, const Outcome& outcome, const Positions& solved);

  // Finds the minimum below the best of the outcomes.
  Minimum reference(const BenchState& state, const std::vector<Outcome>& outcomes);

  const Subject& subject() const { return subject_; }

 private:
  SearchRule& rule_of(const SolverEntry& entry);
  const StepInputs& put(const BenchState& state);
  StepInputs inputs_of(const BenchState& state, const SolverEntry& entry);

  Subject& subject_;
  std::optional<Reference> lowest_;
  OpenWorkspace workspace_, reference_workspace_;
  struct Prepared {
    Method method;
    RuleMaker maker;
    std::unique_ptr<SearchRule> rule;
  };
  std::vector<Prepared> prepared_;
  std::uint64_t prepared_for_;  // id of the values of the subject's model for which solvers are prepared
};

// Evaluates equation 12 for each iteration: 1 - gained / whole. The list is empty when the run failed.
std::vector<double> errors_of(const Outcome& outcome, double whole);

// Evaluates equation 12 at the end of the run; NaN when the run failed.
double last_error(const Outcome& outcome, double whole);

// Returns the first time at which the error is at most `tolerance`, or infinity when it never is [ms].
double time_to(const Outcome& outcome, double whole, double tolerance);
// Does the same with an error for each iteration.
double time_to(const Outcome& outcome, const std::vector<double>& errors, double tolerance);

// Finds the radius with which a method that Chebyshev's semi-iterative method accelerates comes closest to the minimum
// after 30 iterations on a training state, with the delay of Wang 2015.
ChebyshevSettings trained_chebyshev(SolverComparison& comparison, const BenchState& training, const Method& method);

// Trains all of these entries that Chebyshev's method accelerates.
void train_chebyshev(SolverComparison& comparison, const BenchState& training, std::vector<SolverEntry>& entries);

}  // namespace supple
