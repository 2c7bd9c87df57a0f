// Lets the iterations of a step go on for further rounds while its answer gains energy from nothing (energy_gain.h),
// which a step that is left far from its minimum can, again and again: a body that hangs under many times the load that
// its stiffness bears was stretched 368 times. Where it does not act it costs nothing, but for steps whose searches had
// a hard time: these pay an evaluation.
#pragma once

#include "sim/solver/iterations.h"
#include "sim/solver/step_context.h"

namespace supple {

// Tells whether a search that has made the iterations of its limits shall make another round of them: `solver.rounds`
// in all, at most. To be asked before the search looks further, when the report's slope is that of its last iteration.
bool needs_another_round(const StepContext& c, const Iterations& search, const SearchLimits& limits);

// Returns the limits of that round.
SearchLimits with_another_round(const StepContext& c, SearchLimits limits);

}  // namespace supple
