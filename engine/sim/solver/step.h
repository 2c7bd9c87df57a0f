// Makes one time step by quasi-Newton iterations with line search (Liu et al. 2017, algorithms 1 and 2).
#pragma once

#include "sim/solver/first_iterate.h"
#include "sim/solver/search_rule.h"

namespace supple {

// Advances `state` by model.time_step. The state changes only if the step succeeds; the report (workspace.report)
// describes the result. Allocates nothing once the workspace has been prepared for the model, but for contacts and for
// Newton's method. Unless the line search is off, g at the new x is up to round-off no larger than where the body
// stays: at the old x, moved along with the collider or the free fall that carries the body. Friction's potential is
// left out of both, except where Newton's method has finished the step.
const StepReport& step(const Model& model, const StepInputs& inputs, State& state, OpenWorkspace& workspace);

// Does the same with another rule for directions. A rule belongs to one body and may keep memory from step to step.
const StepReport& step(const Model& model, const StepInputs& inputs, State& state, OpenWorkspace& workspace,
                       SearchRule& rule);

}  // namespace supple
