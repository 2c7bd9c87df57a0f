// Treats contact by a separate correction after a step without colliders: the first way of Bouaziz et al. 2014, against
// which section 4.3 of the paper argues.
#pragma once

#include "sim/solver/step.h"

namespace supple {

// Makes a step without colliders, then moves every vertex that is inside a collider to the nearest point of its surface
// and corrects the velocities. The report is that of the step.
const StepReport& step_then_project(const Model& model, const StepInputs& inputs, State& state, Workspace& workspace);

}  // namespace supple
