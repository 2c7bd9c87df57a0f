// The converged reference that errors are measured against: equation 12 for one step that has been made.
#pragma once

#include <memory>
#include <optional>

#include "sim/solver/step.h"

namespace supple {

// The lowest point that can be found below a point.
struct Minimum {
  double below_y = 0;    // g(y) - g*, a sum of small differences [J]
  double below_end = 0;  // g(x) - g* of the point that the search began at [J]
  Positions x;           // where [m]
  // Whether the Hessian there, nothing projected, has a Cholesky factor. A body that is at the edge of a contact, or
  // has springs or fibres under compression, may be at a minimum without.
  bool positive_definite = false;
};

// Finds minima of one body's steps: some L-BFGS, Newton's method to round-off, then L-BFGS again until
// that finds nothing either.
class Reference {
 public:
  explicit Reference(const Model& model);
  ~Reference();

  // From `x`, one of the points that a step from `before` has come to. workspace: scratch of the reference's own.
  Minimum minimum(const Model& model, const StepInputs& inputs, const State& before, const Positions& x,
                  Workspace& workspace);

  // error(x_k) = (g(x_k) - g*) / (g(y) - g*). `before` and `after` are the states around the step. g* is what minimum()
  // finds going on from x_k; both differences are sums of small ones, so that small errors keep their digits. Empty
  // where g(y) - g* is round-off.
  std::optional<double> step_error(const Model& model, const StepInputs& inputs, const State& before,
                                   const State& after, Workspace& workspace);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

// Energy, friction included, of the contacts found anew at x, after begin_step [J].
double contact_energy_at(const Model& model, const StepInputs& inputs, const Positions& x, Workspace& workspace);

// g(y) - g(x) of a step from `before`, handles at their targets, each point with the contacts found there [J]. Leaves
// x in workspace.current.x.
double gained(const Model& model, const StepInputs& inputs, const State& before, const Positions& x,
              Workspace& workspace);

}  // namespace supple
