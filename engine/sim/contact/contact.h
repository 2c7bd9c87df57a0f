// Defines contact of bodies with colliders, with each other and with themselves (Liu et al. 2017, section 4.3). Contact
// adds energies to g and nothing to A. Each touching point of a body, which is a vertex or lies between vertices
// (contact_stencil.h), has the energy k_c min(0, n . u - offset)^2 of a plane, which stays during a line search. Not
// here: how contacts are found (find_contacts.h, surface_contacts.h), how directions take them into account
// (contact_direction.h).
//
// The planes are one-sided: a point that leaves is released at once, even in the middle of a line search, and the
// energy is a continuous function. A point that starts a step below the surface is pushed out no faster than push_out:
// its plane is lowered by what is left of its depth after a step at that velocity. The energy itself therefore contains
// the rule that releases a point by its relative velocity n . ((x - q)/h - v_c), with a small hysteresis: above
// push_out there is no force.
#pragma once

#include <vector>

#include "sim/contact/contact_stencil.h"

namespace supple {

// Says what a contact's point touches: one of two kinds of things. A third kind would have to be told apart wherever
// is_collider() is asked, and where `part` is read.
struct OtherSide {
  std::int32_t collider = -1;  // its number; -1: a place of a part's surface, whose vertices are in the stencil
  std::int32_t part = -1;      // the number of that part; -1: a collider
  bool is_collider() const { return collider >= 0; }
  auto operator<=>(const OtherSide&) const = default;
};

struct Contact {
  ContactStencil stencil;
  OtherSide other;
  Vec3 normal;       // away from the other side
  double offset;     // the plane n . u = offset [m]
  double stiffness;  // k_c [N/m]
  double depth;      // the point's depth below the plane when last found or renewed; 0: near, not touching [m]
  // Names the point in this step: it is the vertex, or the first vertex of an edge that touches another edge, which is
  // why several contacts may have one number (contact_order.h). A point between vertices that touches a collider has a
  // number above those of all vertices.
  std::int32_t number = 0;
  // Friction is lagged; it opposes u - origin along the plane (lagged_friction.h).
  double friction = 0;       // coefficient times normal force [N]
  double coefficient = 0;    // Coulomb's coefficient, or twice that where the point was pressed in before
  double most_pressing = 0;  // no larger normal force causes friction in this step [N]
  // These are kept from iterate to iterate, so that friction does not swing (ease_friction()).
  double friction_change = 0;  // by the last iterate; 0 at a step's first one, and where the change was eased [N]
  int friction_swings = 0;     // how many changes in a row turned back much of the one before
  // This is where u would be if the point had moved with the other side [m]. Colliders without friction leave it at 0.
  Vec3 origin = Vec3::Zero();
  double stick = 0;  // friction is whole above this slip in a step [m]
};

// Returns how far a contact's point is above its plane, negative below [m].
inline double gap(const Contact& contact, const Positions& x) {
  return contact.normal.dot(contact.stencil.at(x)) - contact.offset;
}

// Renews contacts at other positions, where their planes stay as they are: sets their depths, and the friction that
// follows from these. Returns how many of the contacts began or ceased to touch.
int renew_contacts(const Positions& x, std::vector<Contact>& contacts);

// Returns the share of friction in the energy [J].
double friction_energy(const std::vector<Contact>& contacts, const Positions& point);

// Returns the stiffness of friction along the plane at x [N/m].
double friction_stiffness(const Contact& contact, const Positions& x);

// Returns the share of the normal forces in the energy [J].
double contact_energy(const std::vector<Contact>& contacts, const Positions& point);

// Adds the force of each contact with a collider, friction included, to that of this collider on the body [N].
void add_forces(const std::vector<Contact>& contacts, const Positions& point, std::vector<Vec3>& by_collider);

// Holds the share of contacts in an objective.
struct ContactChange {
  double value = 0;  // [J]
  double slope = 0;  // along the direction, where a gradient is given [J]
};

// Returns the energy of the contacts at a point, friction included, or its difference from the energy at a reference
// point (null: none). Where a gradient is given (null: none), adds `sign` times the gradient of the contacts to it.
ContactChange add_contacts(const std::vector<Contact>& contacts, const Positions& point, const Positions* reference,
                           const Positions& direction, Positions* gradient, double sign = 1);

}  // namespace supple
