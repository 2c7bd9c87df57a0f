// Finds the converged reference against which errors are measured: equation 12 for one step that has been made.
#pragma once

#include <memory>
#include <optional>

#include "sim/solver/step.h"

namespace supple {

// Holds the lowest point that can be found below a given point.
struct Minimum {
  double below_y = 0;    // g(y) - g*, a sum of small differences [J]
  double below_end = 0;  // g - g* at the point where the search began [J]
  Positions x;           // positions at the minimum [m]
  // Tells whether the Hessian there, without any projection, has a Cholesky factor. A body that is at the edge of a
  // contact, or has springs or fibres under compression, may be at a minimum where the Hessian has none.
  bool positive_definite = false;
};

// Finds minima of one body's steps: first by some iterations of L-BFGS, then by Newton's method to round-off, then by
// L-BFGS again until that gains nothing either.
class Reference {
 public:
  explicit Reference(const Model& model);
  ~Reference();

  // Finds the minimum from `x`, one of the points that a step from `before` has reached. workspace: scratch memory for
  // the reference alone.
  Minimum minimum(const Model& model, const StepInputs& inputs, const State& before, const Positions& x,
                  OpenWorkspace& workspace);

  // Holds the errors of a step.
  struct StepErrors {
    std::optional<double> error;  // of equation 12; empty where g(y) - g* is round-off
    double motion = 0;            // the error of motion (sim/model/motion_error.h)
  };
  // Returns the errors of a step: that of equation 12, error(x_k) = (g(x_k) - g*) / (g(y) - g*), and that of motion.
  // `before` and `after` are the states around the step. g* is what minimum() finds when it continues from x_k. Both
  // differences are sums of small ones, so that small errors keep their digits.
  StepErrors step_errors(const Model& model, const StepInputs& inputs, const State& before, const State& after,
                         OpenWorkspace& workspace);
  // Returns the error of equation 12 alone.
  std::optional<double> step_error(const Model& model, const StepInputs& inputs, const State& before,
                                   const State& after, OpenWorkspace& workspace) {
    return step_errors(model, inputs, before, after, workspace).error;
  }

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

// Returns the energy, friction included, of the contacts that are found anew at x [J]. begin_step() must have been
// called for the step.
double contact_energy_at(const Model& model, const StepInputs& inputs, const Positions& x, OpenWorkspace& workspace);

// Returns g(y) - g(x) of a step from `before` [J], with handles at their targets, and at both points with the contacts
// that are found there. Leaves x in workspace.current.x.
double gained(const Model& model, const StepInputs& inputs, const State& before, const Positions& x,
              OpenWorkspace& workspace);

}  // namespace supple
