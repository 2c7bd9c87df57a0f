// Finds how far along a direction the next iterate lies.
#pragma once

#include "sim/model/inputs.h"
#include "sim/solver/objective.h"

namespace supple {

enum class Search {
  found,
  worse,  // a point was found, but contacts that the current iterate could not learn make it worse
  failed,
  unforeseen,  // contacts lay on the way; the current iterate knows them now, so that another direction is needed
  exhausted,   // what the direction promises is below what the gradient's own round-off decides
};

// Searches from the current iterate along workspace.direction (with this slope [J]) by Armijo's backtracking. Leaves
// the accepted point in workspace.trial, with gradient and energies by the contacts of the current iterate and, in its
// contacts, those found there. may_learn: whether the search may end as `unforeseen` (learn_contacts()); otherwise
// steps become shorter. `record` gets the step length and the results of the full step. Where the present iteration may
// be the search's last one, and a full step that is no arc is taken, elements are in double precision from then on.
Search search_line(const Model& model, const StepInputs& inputs, OpenWorkspace& workspace, double slope, bool may_learn,
                   Change& change, IterationRecord& record);

// Tells whether a direction is too short to change more than the positions' last bits, so that nothing is left to gain.
// Such directions include the round-off of a body at rest, which must not be integrated into a drift.
bool below_resolution(const Model& model, const OpenWorkspace& workspace);

// Returns the largest coordinate, relative to which positions are rounded [m].
double extent_of(const Model& model, const OpenWorkspace& workspace);

}  // namespace supple
