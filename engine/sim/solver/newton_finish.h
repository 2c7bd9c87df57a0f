// Finishes steps that the quasi-Newton iterations left far from their minimum: by Newton's method, whose directions
// know what the one stiffness of A does not, such as elements that are pressed nearly flat. Hard steps are few, so they
// may be dear. Other steps pay nothing, or the evaluation of gains_energy() (energy_gain.h).
#pragma once

#include "sim/solver/step_context.h"

namespace supple {

// Tells whether Newton's method finishes this body's hard steps: where the settings let it, the body makes its step
// alone by backward Euler, and time has no bound. It does not where a direction would cost more than 200 evaluations
// (from about 7,000 vertices), nor for a body without tetrahedra: compressed springs leave the projected Hessian
// without stiffness across them, so that its directions are too long (a sheet on bars took 108 trials a step, and
// gained energy).
bool may_finish_by_newton(const Model& model, const StepInputs& inputs);

// Returns how many points the line searches of a search with so many iterations may try before it gives up, because
// Newton's method does better there; without bound where Newton's method does not follow.
int trials_before_newton(const StepContext& c, int iterations);

// Tells why a step is hard.
enum class Hardness {
  none,           // the step is not hard, or Newton's method is not for this body
  gains_energy,   // the step gains energy from nothing
  far_in_energy,  // a search gave up, or the error of equation 12 is large, or the searches tried many points
  far_in_motion,  // the error of motion alone is large: impacts that turn a stiff body
};
Hardness hardness_of(const StepContext& c);

// Iterates from the current iterate, never uphill, until the gain that a direction promises is next to nothing beside
// what the step has gained. Estimates the errors of the step again.
void finish_by_newton(StepContext& c, Hardness hardness);

}  // namespace supple
