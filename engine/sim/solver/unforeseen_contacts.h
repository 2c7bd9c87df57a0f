// Deals with contacts that a search along a direction did not foresee, because they were found only where it led.
#pragma once

#include "sim/model/inputs.h"
#include "sim/solver/workspace.h"

namespace supple {

// Keeps vertices of the trial iterate on the side of a collider that holds them at the current one. A vertex belongs to
// the surface through which the straight way from its start leads. When it slides off a side, around an edge, that is
// suddenly another surface, far above it, and the energy would jump by more than all else. So where a vertex hardly
// overlapped at the current iterate, although it lay deep below the new plane already, the plane of the current iterate
// stays.
void keep_sides(const Model& model, const StepInputs& inputs, Workspace& workspace);

// Adds to the current iterate's contacts the planes that a refused trial iterate met and that the current one had not
// found: those ahead of it, and those of points of edges and faces that were chosen on the way. Corrects the objective
// and its gradient. Returns whether there was anything to add: then a direction from here knows more than the last one.
bool learn_contacts(const Model& model, const StepInputs& inputs, Workspace& workspace);

}  // namespace supple
