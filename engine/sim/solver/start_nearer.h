// Moves the first iterate nearer to where the body was, where that is better than what the body would do freely. Of
// several bodies, only those are moved that give cause for it.
#pragma once

#include "sim/solver/step_context.h"

namespace supple {

// Tells whether a body hangs still, or lies: it moves so little that the forces on it must be balanced.
bool hangs_still(const StepContext& c);

// Starts from q + h v where that is better. y contains the fall of the step, |gravity| h^2. A body that rests on
// something, or slides along it, is that deep in it at y, and a body that hangs still is that far below where it stays:
// the iterations of a soft one bring it no nearer than it was at q, and it needs as many again. The other start costs
// an evaluation, so it is tried only where the body touches something or hardly moves.
void start_without_fall(StepContext& c);

// Tells whether points touch that are not vertices on a collider: points between vertices, or bodies that touch each
// other. Where they rest on something thin, the free motion of the body leads through it.
bool touches_between_vertices(const StepContext& c);

// Starts from q where that is far better. This costs an evaluation, and only where inertia alone does not rule q out.
void start_where_it_was(StepContext& c);

}  // namespace supple
