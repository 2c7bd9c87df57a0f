// Tells from which normal force the friction of a contact follows in a step.
#pragma once

#include <algorithm>

#include "sim/contact/contact.h"

namespace supple {

// Returns the normal force from which friction follows (Li et al. 2020, section 5.3, lag it too) [N]. It is the force
// on the point when the step began or, where the point arrives or comes out of a deep overlap, at most the force that
// stops it alone. The overlap of an iterate would give a force that is many times too large; it only reduces friction,
// smoothly, on a point that is leaving. With a jump at the surface, points would touch and leave without end.
// depth_before: when the step began; depth_unhindered: at the prediction [m].
inline double lagged_force(const Contact& contact, double depth_before, double depth_unhindered, double mass_over_h2) {
  const double pressing = 2 * contact.stiffness * contact.depth;
  if (depth_before > 0) return 2 * std::min(contact.stiffness * depth_before, pressing);
  return std::min(mass_over_h2 * std::max(0.0, depth_unhindered), pressing);
}

}  // namespace supple
