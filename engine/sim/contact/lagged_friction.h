// Tells from which normal force the friction of a contact follows in a step. It is the force on the point when the step
// began or, where the point arrives or comes out of a deep overlap, at most the force that stops it alone (Li et al.
// 2020, section 5.3, lag it too). The overlap of an iterate would give a force that is many times too large; the
// overlap only reduces friction, smoothly, on a point that is leaving. With a jump at the surface, points would touch
// and leave without end.
//
// Friction that follows from an iterate's depths is a fixed-point iteration, and may swing for ever: more friction
// turns a ball further, which lifts the point, which lessens the friction. Where it swings, the secant through its last
// two changes says where it would stay.
#pragma once

#include <algorithm>
#include <vector>

#include "sim/contact/contact.h"

namespace supple {

// Sets the friction of a contact at its present depth.
inline void renew_friction(Contact& contact) {
  contact.friction = contact.coefficient * std::min(contact.most_pressing, 2 * contact.stiffness * contact.depth);
}

// Begins the friction of a contact in a step. A point that was pressed in when the step began keeps its friction until
// its depth is half of what it was. coefficient: that of Coulomb's law; depth_before, depth_unhindered: the point's
// depth when the step began, and at the prediction [m]; mass_over_h2: the point's mass over h^2, times the scheme's
// factor of inertia [N/m].
inline void begin_friction(double coefficient, double depth_before, double depth_unhindered, double mass_over_h2,
                           Contact& contact) {
  const bool was_pressed = depth_before > 0;
  contact.coefficient = was_pressed ? 2 * coefficient : coefficient;
  contact.most_pressing =
      was_pressed ? contact.stiffness * depth_before : mass_over_h2 * std::max(0.0, depth_unhindered);
  renew_friction(contact);
}

// Eases the friction of contacts that were found at the next iterate, where it goes on swinging: after two changes in a
// row that turn back more than half of the one before (and are not next to nothing), the last one is made only up to
// where the secant crosses zero (Irons and Tuck 1969, "A version of the Aitken accelerator for computer iteration").
// One such change may be due to anything. before: the contacts of the iterate; both lists are ordered
// (contact_order.h), and touch no cloth.
void ease_friction(const std::vector<Contact>& before, std::vector<Contact>& next);

}  // namespace supple
