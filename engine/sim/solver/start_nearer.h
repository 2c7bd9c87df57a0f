// Moves the first iterate nearer to where the body was, where that is better than what the body would do freely.
#pragma once

#include "sim/solver/step_context.h"

namespace supple {

// Tells whether the body moves so little that what acts on it must be balanced: it hangs still, or lies.
bool is_still(const StepContext& c);

// Starts from q + h v where that is better. y contains the fall of the step, which leaves a body that rests on
// something, or slides along it, g h^2 deep in its colliders, and one that hangs still that far from where it stays: a
// soft one comes no nearer in its iterations than it was, and needs as many again. This costs an evaluation, so it is
// tried only where something touches or hardly moves.
void start_without_fall(StepContext& c);

// Tells whether points between vertices touch. Those that rest in something thin have no room: what the body would do
// freely leads through it.
bool touches_between_vertices(const StepContext& c);

// Starts from q where that is far better. This costs an evaluation, and only where inertia alone does not rule q out.
void start_where_it_was(StepContext& c);

}  // namespace supple
