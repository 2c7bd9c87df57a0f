// Keeps the momentum of bodies that only touch each other. What one of them gets the other loses, so that together they
// move as nothing but gravity says, whatever the directions of a search do to each; directions with contacts come from
// factors in single precision, and know this to some seven digits. A step of a body alone has its translation exactly
// by restore_translation (sim/model/system_solve.h).
#pragma once

#include "sim/solver/open_workspace.h"

namespace supple {

// Tells whether nothing holds, stops or drags the parts of a joined model from outside; false for a body alone.
bool is_isolated(const Model& model, const OpenWorkspace& w, const std::vector<Contact>& contacts);

// Shifts all free vertices, so that their common centre of mass is that of y.
void keep_center(const Model& model, const Positions& y, Positions& x);

// Shifts the direction at the current iterate, so that the full step brings the centre of mass where Newton's law says.
// Returns the change of the slope [J].
double restore_common_translation(const Model& model, OpenWorkspace& w);

// Takes the motion of the centre of mass out of a motion.
void take_out_translation(const Model& model, Positions& motion);

}  // namespace supple
