// Lets the iterations of a step go on, for two reasons. The first is that its answer gains energy from nothing
// (energy_gain.h), as steps that are left far from their minimum can do again and again: a body that hung under many
// times the load that its stiffness bears was stretched 368 times. The second is that the body has so much of its way
// left to go that it can be seen (error_estimate.h, is_far). Most such steps come near within a few more iterations,
// and a direction of Newton's method (newton_finish.h), which has what is still hard then, costs as much as 20 to 200
// evaluations. A step that need not go on pays next to nothing; where its searches had a hard time, an evaluation each
// time that it is asked.
#pragma once

#include "sim/solver/iterations.h"
#include "sim/solver/step_context.h"

namespace supple {

// Returns how many more iterations a search shall make that has made all of its limits: another round of them while it
// gains energy, up to `solver.rounds` rounds in all; a few while the body is far, up to three of these rounds in all;
// or 0. To be asked before the search looks further, when the report's slope is that of its last iteration. So what
// that iteration did counts as left to go; to know better would cost another direction. Overwrites the trial iterate.
int further_iterations(const StepContext& c, const Iterations& search, const SearchLimits& limits);

// Returns the limits with room for more iterations.
SearchLimits with_more(const StepContext& c, SearchLimits limits, int iterations);

}  // namespace supple
