// Stops the first iterate at an impact. Far below a surface, it would start from torn or inverted elements, or beyond
// the collider. It costs nothing without colliders; with them, a search along the ways of the vertices in each step,
// and two evaluations where the collider that stops the body moves.
#pragma once

#include "sim/solver/step_context.h"

namespace supple {

// Finds the first impact on the way from q to the current iterate; its collider is -1 where there is none.
Impact find_impact(const StepContext& c);

// Lets the body go only as far as the impact and a little further. If the collider moves, the body then goes on with
// it: at the end of the step, it lies before the collider as it would if the same impact were seen from the collider.
// That is not better for a body that is held, or that is carried into another collider; there, the lower objective
// decides. The new first iterate is not evaluated yet.
void stop_at_impact(StepContext& c, const Impact& impact);

}  // namespace supple
