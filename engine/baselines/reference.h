// The converged reference that errors are measured against: equation 12 for one step that has been made.
#pragma once

#include <optional>

#include "sim/step.h"

namespace supple {

// error(x_k) = (g(x_k) - g*) / (g(y) - g*). `before` and `after` are the states around the step. g* is where L-BFGS,
// going on from x_k, finds nothing more; both differences are sums of small ones, so that small errors keep their
// digits. Empty where g(y) - g* is round-off. workspace: scratch of the reference's own.
std::optional<double> step_error(const Model& model, const FrameInputs& inputs, const State& before, const State& after,
                                 Workspace& workspace);

}  // namespace supple
