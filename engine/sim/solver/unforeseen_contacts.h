// Deals with contacts that a search along a direction did not foresee, because they were found only where it led. Each
// such search costs another direction; a step in which contacts refuse no trial iterate pays nothing.
#pragma once

#include "sim/model/inputs.h"
#include "sim/solver/open_workspace.h"

namespace supple {

// The number of further directions that one iteration may ask for because of such contacts; after them, the line search
// shortens its steps.
inline constexpr int most_lessons = 3;

// Adds to the current iterate's contacts the planes that a refused trial iterate met and that the current one had not
// found: planes ahead of it, and planes of points of edges and faces that were chosen on the way. Corrects the
// objective and its gradient. Returns whether there was anything to add: then a direction from here knows more than the
// last one.
bool learn_contacts(const Model& model, const StepInputs& inputs, OpenWorkspace& workspace);

}  // namespace supple
