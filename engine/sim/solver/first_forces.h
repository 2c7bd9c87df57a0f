// Finds how hard a body that touches colliders when a film begins is pressed on them. Friction in a step follows from
// the normal forces at its start (sim/contact/lagged_friction.h), which the step before has left in the overlaps; no
// step comes before the first one, so a body that begins at rest on a slope, or sliding on the ground, would be without
// friction for that step.
#pragma once

#include "sim/model/inputs.h"
#include "sim/model/state.h"
#include "sim/solver/open_workspace.h"

namespace supple {

// Sets workspace.contact.pressed_at_first in the first step (state.time is 0) of a body that touches a collider with
// friction; does nothing in other cases. The forces are those that the step ends with, by the standard solver, in a few
// rounds.
void find_first_forces(const Model& model, const StepInputs& inputs, const State& state, OpenWorkspace& workspace);

}  // namespace supple
