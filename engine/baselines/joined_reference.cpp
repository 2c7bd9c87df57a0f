#include "baselines/joined_reference.h"

#include <algorithm>
#include <cmath>

#include "baselines/reference.h"
#include "sim/model/motion_error.h"
#include "sim/solver/error_estimate.h"
#include "sim/solver/iterations.h"
#include "sim/solver/lbfgs.h"
#include "sim/solver/place_iterate.h"

namespace supple {
namespace {

constexpr int most_iterations = 3000;
constexpr int iterations_a_look = 25;    // after so many, the estimates are compared with the two targets
constexpr double enough_energy = 1e-10;  // left to gain, over g(y) - g*
constexpr double enough_motion = 1e-5;   // left to move, over a body's motion

StepInputs thorough(const StepInputs& inputs) {
  StepInputs result = inputs;
  result.solver = SolverSettings{};
  result.solver.iterations = most_iterations;
  result.solver.history = 20;
  result.solver.contact = inputs.solver.contact;
  result.solver.contact.direction = ContactDirection::low_rank;
  return result;
}

// Follows the iterates down, and keeps the lowest that it sees: contacts which are found on the way may raise g.
class Descent {
 public:
  // reached: g(y) - g(x) at the point x where it begins, which is in the workspace [J].
  Descent(const Model& model, const StepInputs& inputs, const Positions& q, double reached, OpenWorkspace& w)
      : model_(model), inputs_(inputs), q_(q), reached_(reached), w_(w), lowest_(w.current.x) {}

  // Returns whether it has converged. A search whose line search fails, at a crease of the contact set, begins anew
  // without its history for as long as that gains anything.
  bool run() {
    while (left_ > 0) {
      const double before = w_.report.decrease;
      if (search()) return is_lowest();
      const bool gives_up = w_.report.failed || w_.report.decrease - before <= enough_energy * whole();
      if (gives_up) return false;
    }
    return false;
  }

  const Positions& lowest() const { return lowest_; }
  double gained() const { return gained_; }  // from the beginning to the lowest iterate [J]

 private:
  bool is_lowest() const { return gained_ - w_.report.decrease <= enough_energy * whole(); }
  double whole() const { return std::abs(reached_) + gained_; }

  // Runs one search. Returns whether it has converged.
  bool search() {
    SystemInverse system;
    LbfgsRule rule(system);
    evaluate_start(model_, inputs_, w_);
    Iterations iterations(model_, inputs_, w_, rule, {&q_, reached_});
    for (SearchLimits limits; limits.iterations < left_;) {
      limits.iterations = std::min(left_, limits.iterations + iterations_a_look);
      iterations.run(limits);
      if (!w_.report.failed) keep_lowest();
      if (w_.report.failed || iterations.end() == SearchEnd::settled || is_solved()) break;
    }
    left_ -= std::max(w_.report.iterations, 1);
    if (w_.report.failed) return false;
    if (iterations.end() == SearchEnd::settled) return w_.report.stop_reason == StopReason::round_off;
    return is_solved();
  }

  // Tells whether both estimates, which are those before the last iteration, are below their targets.
  bool is_solved() {
    return error_of(w_.report.remaining_estimate, reached_ + w_.report.decrease) < enough_energy &&
           motion_ahead(model_, inputs_, q_, w_) < enough_motion;
  }

  void keep_lowest() {
    if (w_.report.decrease <= gained_) return;
    gained_ = w_.report.decrease;
    lowest_ = w_.current.x;
  }

  const Model& model_;
  const StepInputs& inputs_;
  const Positions& q_;
  double reached_;
  OpenWorkspace& w_;
  Positions lowest_;
  double gained_ = 0;
  int left_ = most_iterations;
};

}  // namespace

JoinedErrors joined_errors(const Model& model, const StepInputs& inputs, const State& before, const State& after,
                           OpenWorkspace& w) {
  const StepInputs by_lbfgs = thorough(inputs);
  w.prepare(model, by_lbfgs.solver);
  w.report = StepReport{};
  const double reached = gained(model, by_lbfgs, before, after.x, w);
  Descent descent(model, by_lbfgs, before.x, reached, w);
  JoinedErrors errors;
  errors.converged = descent.run();
  errors.motion = motion_errors(model, before.x, w.y, after.x, descent.lowest());
  w.trial.x = w.y;
  w.trial.contacts = w.current.contacts;
  evaluate(model, w, w.trial, Wanted::value);
  const double noise = 2 * noise_of(model, w.trial.g, before.x.cwiseAbs().maxCoeff());
  const double below_y = reached + descent.gained();
  if (below_y > noise) errors.error = descent.gained() / below_y;
  return errors;
}

}  // namespace supple
