// Chooses where the iterations of a step start: y, or a better point where handles or colliders make y a bad one.
#pragma once

#include "sim/solver/begin_step.h"
#include "sim/solver/place_iterate.h"
#include "sim/solver/step_context.h"

namespace supple {

// Chooses workspace.current among the candidates, in the order of first_iterate.cpp, and evaluates it with its
// gradient. Sets what the context says of the first iterate. To be called after begin_step() and choose_matrix().
void set_first_iterate(StepContext& c);

}  // namespace supple
