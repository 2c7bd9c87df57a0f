// Contact as a separate correction after a step without colliders: the first way of Bouaziz et al. 2014 that
// section 4.3 of the paper argues against.
#pragma once

#include "sim/solver/step.h"

namespace supple {

// Makes a step without colliders; then puts every vertex that is inside one on the nearest point of its surface, and
// corrects velocities. The report is the step's.
const StepReport& step_then_project(const Model& model, const StepInputs& inputs, State& state, Workspace& workspace);

}  // namespace supple
