// How far along a direction the next iterate lies.
#pragma once

#include "sim/model/inputs.h"
#include "sim/solver/objective.h"

namespace supple {

enum class Search {
  found,
  failed,
  exhausted,  // what the direction promises is below what the gradient's own round-off decides
};

// Searches from the current iterate along workspace.direction (of this slope [J]) as the settings say. Leaves the
// accepted point in workspace.trial, with gradient and energies by the contacts of the current iterate and, in its
// contacts, those found there. `record` gets the step length and how the full step did.
Search search_line(const Model& model, const StepInputs& inputs, Workspace& workspace, double slope, Change& change,
                   IterationRecord& record);

// A direction too short to change the positions' last bits: nothing is left to gain. Also true of the round-off of a
// body at rest, which must not be integrated into a drift.
bool below_resolution(const Model& model, const Workspace& workspace);

// The largest coordinate: what positions are rounded against [m].
double extent_of(const Model& model, const Workspace& workspace);

}  // namespace supple
