// One time step by quasi-Newton iterations with line search (Liu et al. 2017, algorithms 1 and 2).
#pragma once

#include "sim/solver/first_iterate.h"
#include "sim/solver/search_rule.h"

namespace supple {

// Advances `state` by model.time_step. The state changes only if the step succeeds; the report (workspace.report) says
// how it went. Allocates nothing once the workspace has seen the model. Unless the line search is off, g(new x) <=
// g(old x): staying is the last resort.
const StepReport& step(const Model& model, const StepInputs& inputs, State& state, Workspace& workspace);

// The same with another rule for directions. A rule belongs to one body; it may remember what it likes from step to
// step.
const StepReport& step(const Model& model, const StepInputs& inputs, State& state, Workspace& workspace,
                       SearchRule& rule);

// Minimises g from workspace.current.x; the report's decrease, slope and stop reason tell how far it came. Also stops
// once a direction promises less than `enough` [J]. For step() and for references.
void minimize(const Model& model, const StepInputs& inputs, Workspace& workspace, double enough = 0);
void minimize(const Model& model, const StepInputs& inputs, Workspace& workspace, SearchRule& rule, double enough = 0);

}  // namespace supple
