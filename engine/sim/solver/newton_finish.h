// Finishes steps that the quasi-Newton iterations left far from their minimum: by Newton's method, whose directions
// know what the one stiffness of A does not, such as elements that are pressed nearly flat. Hard steps are few, so they
// may be dear.
#pragma once

#include "sim/solver/iterations.h"

namespace supple {

// Tells whether this body's hard steps are finished so. Not where a direction would cost more than 200 evaluations
// (from about 7,000 vertices); nor for a body of springs alone, where compressed springs leave the projected Hessian
// without stiffness across them, so that its directions are too long (a sheet on bars took 108 trials a step, and
// gained energy).
bool may_finish_by_newton(const Model& model, const StepInputs& inputs);

// Goes on where the iterations of a step gave up (hopeless), left it far from its minimum by one of the estimates of
// the report, or gained energy from nothing, until a direction promises next to nothing of what the step has gained,
// but never uphill. Returns whether it did.
bool finish_by_newton(const Model& model, const StepInputs& inputs, const Origin& origin, Workspace& workspace,
                      bool hopeless);

}  // namespace supple
