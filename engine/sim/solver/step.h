// Makes one time step by quasi-Newton iterations with line search (Liu et al. 2017, algorithms 1 and 2).
#pragma once

#include "sim/solver/first_iterate.h"
#include "sim/solver/search_rule.h"

namespace supple {

// Advances `state` by model.time_step. The state changes only if the step succeeds; the report (workspace.report)
// describes the result. Allocates nothing once the workspace has been prepared for the model, but for Newton's method.
// Unless the line search is off, g at the new x, without friction's potential, is up to round-off no larger than where
// the body stays: at the old x, moved along with the collider or the free fall that carries the body.
const StepReport& step(const Model& model, const StepInputs& inputs, State& state, Workspace& workspace);

// Does the same with another rule for directions. A rule belongs to one body and may keep memory from step to step.
const StepReport& step(const Model& model, const StepInputs& inputs, State& state, Workspace& workspace,
                       SearchRule& rule);

// Minimises g from workspace.current.x; adds to the report's decrease, and sets its slope and stop reason. Also stops
// once a direction promises less than `enough` [J]. It serves step() and references.
void minimize(const Model& model, const StepInputs& inputs, Workspace& workspace, double enough = 0);
void minimize(const Model& model, const StepInputs& inputs, Workspace& workspace, SearchRule& rule, double enough = 0);

}  // namespace supple
