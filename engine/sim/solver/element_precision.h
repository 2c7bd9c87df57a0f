// Chooses the precision in which a search evaluates elements. A search may begin in single precision, which takes some
// 0.6 of the time, and goes over to double where single precision is no longer enough: gradients, and so directions,
// then have as much round-off as there is left to gain. Where it goes over depends on states alone. What a search
// leaves is always evaluated in double precision, so that energies, errors and remaining gradients in reports are
// double: either the last iteration's first trial is evaluated so (line_search.cpp), or its last iterate is evaluated
// again. g of the iterates before has the round-off of single precision (objective.h).
#pragma once

#include "sim/solver/step_context.h"

namespace supple {

// Tells whether the rule and the settings let the first search of a step begin in single precision. A step with a
// target of error often ends after an iteration or two. Bodies with slack (Model::has_slack) amplify round-off: turned
// copies of one that hangs were 1e-3 of its size apart after 60 steps in single precision, and below 1e-5 in double.
bool may_begin_in_single(const StepContext& c);

// Chooses the precision for the first iterate of a step: single where the step before began in it, and this one may,
// too.
void expect_precision(const StepContext& c);

// Takes single precision at the first direction of a search, where that is worth it. slope: tr(grad^T d) [J].
void begin_in_single(const Model& model, double slope, OpenWorkspace& workspace);

// Tells whether what a direction promises is well above the round-off of gradients of single precision. slope:
// tr(grad^T d) [J].
bool is_single_enough(const Model& model, double slope);

// Goes over to double precision, and evaluates the current iterate again. Returns false where it has double precision
// already.
bool go_over_to_double(const Model& model, OpenWorkspace& workspace);

}  // namespace supple
