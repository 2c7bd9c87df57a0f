// Bends a search into an arc where its direction turns parts of the body so far that a straight line would stretch them
// (coarse/turning.h): that costs a stiff body more energy than all else in a step. Directions with one level pay
// nothing; those with two pay a look at the body's clusters, and a solve with A where the arc matters.
#pragma once

#include "sim/model/inputs.h"
#include "sim/solver/open_workspace.h"

namespace supple {

// Sets the arc of a search along workspace.direction (OpenWorkspace::bow), or no arc where the stretching along a
// straight line takes only a small share of the gain that the direction promises. slope: tr(grad^T d), less than 0 [J].
void bow_search(const Model& model, const StepInputs& inputs, double slope, OpenWorkspace& workspace);

}  // namespace supple
