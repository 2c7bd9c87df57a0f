// Contact as a separate step behind an oblivious one: the first way of Bouaziz et al. 2014 that section 4.3 of the
// paper argues against.
#pragma once

#include "sim/solver/step.h"

namespace supple {

// A step that knows of no collider; then every vertex inside one is put on the nearest point of its surface, and
// velocities follow. The report is the step's.
const StepReport& step_then_project(const Model& model, const FrameInputs& inputs, State& state, Workspace& workspace);

}  // namespace supple
