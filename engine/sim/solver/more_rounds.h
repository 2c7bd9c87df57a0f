// Lets the iterations of a step go on for further rounds while its answer gains energy from nothing (energy_gain.h), as
// steps that are left far from their minimum can do again and again: a body that hung under many times the load that
// its stiffness bears was stretched 368 times. A step that needs no further round pays nothing, or one evaluation where
// its searches had a hard time.
#pragma once

#include "sim/solver/iterations.h"
#include "sim/solver/step_context.h"

namespace supple {

// Tells whether a search that has made the iterations of its limits shall make another round of them: `solver.rounds`
// in all, at most. To be asked before the search looks further, when the report's slope is that of its last iteration.
bool needs_another_round(const StepContext& c, const Iterations& search, const SearchLimits& limits);

// Returns the limits with room for one more round.
SearchLimits with_another_round(const StepContext& c, SearchLimits limits);

}  // namespace supple
