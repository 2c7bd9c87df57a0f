// Stops the first iterate at an impact, because far below a surface the step would start from torn or inverted
// elements, or beyond the collider. This costs nothing where nothing can be touched. Otherwise each step pays a search
// along the ways of the vertices, and two evaluations for each part that a moving collider stops.
#pragma once

#include "sim/solver/step_context.h"

namespace supple {

// Finds the first impact of each part on the way from q to the current iterate; empty where there is none.
std::vector<Impact> find_impacts(const StepContext& c);

// Lets each part go only as far as its impact and a little further. If the collider moves, the part then goes on with
// it: at the end of the step, it lies before the collider as it would if the same impact were seen from the collider. A
// body that is held, or that would be carried into another collider, may be better off where it stops, so the lower
// objective decides. The new first iterate is not evaluated yet.
void stop_at_impacts(StepContext& c, const std::vector<Impact>& impacts);

}  // namespace supple
