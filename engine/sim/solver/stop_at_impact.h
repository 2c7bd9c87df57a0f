// Stops the first iterate at an impact, because far below a surface the step would start from torn or inverted
// elements, or beyond the collider. This costs nothing without colliders. With them, each step pays a search along the
// ways of the vertices, and two evaluations where the collider that stops the body moves.
#pragma once

#include "sim/solver/step_context.h"

namespace supple {

// Finds the first impact on the way from q to the current iterate; its collider is -1 where there is none.
Impact find_impact(const StepContext& c);

// Lets the body go only as far as the impact and a little further. If the collider moves, the body then goes on with
// it: at the end of the step, it lies before the collider as it would if the same impact were seen from the collider.
// To go on with the collider is not better for a body that is held, or that is carried into another collider, so the
// lower objective decides. The new first iterate is not evaluated yet.
void stop_at_impact(StepContext& c, const Impact& impact);

}  // namespace supple
