// Contact of one body's vertices with rigid colliders (Liu et al. 2017, section 4.3): energies in g, nothing in A. Each
// touching vertex has the energy k_c min(0, n . x - offset)^2 of a plane that was found when the iteration began.
// Not here: how directions take contacts into account (contact_direction.h), contact of bodies with each other.
//
// The planes are one-sided: a vertex that leaves is let go at once, in the middle of a line search too, and the energy
// is a continuous function. A vertex that starts a step below the surface is pushed out no faster than push_out: its
// plane lies that much lower. So the rule that releases a vertex by its relative velocity, n . ((x - q)/h - v_c) above
// a small hysteresis, is the energy's own: above push_out there is no force.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/model/inputs.h"
#include "sim/model/model.h"
#include "sim/model/report.h"

namespace supple {

struct Workspace;

struct Contact {
  std::int32_t vertex;
  std::int32_t collider;
  Vec3 normal;       // away from the collider
  double offset;     // the plane n . x = offset [m]
  double stiffness;  // k_c [N/m]
  double depth;      // below the plane where it was found; 0: near, not touching [m]
  // Friction, lagged: it opposes x - origin along the plane.
  double friction = 0;         // coefficient times normal force [N]
  Vec3 origin = Vec3::Zero();  // where the vertex would be had it moved with the collider [m]
};

// What a search asks of a shape once.
struct ColliderTraits {
  double certainty;       // Shape::certainty
  double half_thickness;  // Shape::half_thickness [m]
};

// Scratch of contact; empty while there are no colliders.
struct ContactWork {
  std::vector<Contact> found;    // by collider and vertex
  std::vector<Contact> earlier;  // of the iteration before
  std::vector<std::vector<Contact>> by_chunk;
  std::vector<double> clearance;       // signed distance at the start, colliders x free; NaN: not asked yet [m]
  std::vector<double> group_distance;  // least distance of a group's vertices at the start, colliders x groups [m]
  std::vector<double> group_move;      // largest of a group's vertices, start to iterate [m]
  std::vector<double> collider_move;   // of the collider's own points near a group, colliders x groups [m]
  std::vector<ColliderTraits> traits;  // by collider
  Positions start;                     // q of the free vertices [m]
  double stick_length = 0;             // friction is whole above this slip in a step [m]
  std::uint64_t set_before = 0, set_now = 0;
  ContactCounts counts;
};

// Prepares a step from q: what can touch at all.
void begin_contacts(const Model& model, const FrameInputs& inputs, const Positions& q, Workspace& workspace);

// Finds the contacts of the vertices at x, on their way from q, into workspace.contact.found; what was there goes to
// workspace.contact.earlier.
void find_contacts(const Model& model, const FrameInputs& inputs, const Positions& x, Workspace& workspace);

// How much of the way from q to x the body can go before a vertex is deeper than `allowed` below a surface that it
// enters on the way, 0 to 1.
double free_way(const Model& model, const FrameInputs& inputs, const Positions& x, double allowed,
                Workspace& workspace);

// Counts what changed since the last contacts that were kept.
void keep_contacts(ContactWork& work);

// Friction's part of the energy [J].
double friction_energy(const std::vector<Contact>& contacts, double stick_length, const Positions& point);

// Stiffness of friction along the plane at x [N/m].
double friction_stiffness(const Contact& contact, const Positions& x, double stick_length);

// Normal forces' part of the energy [J].
double contact_energy(const std::vector<Contact>& contacts, const Positions& point);

// force += sign times the normal forces at a point [N].
void add_normal_forces(const std::vector<Contact>& contacts, const Positions& point, double sign, Positions& force);

// Energy, friction included, of the contacts found anew at x, after begin_contacts; leaves none behind [J].
double contact_energy_at(const Model& model, const FrameInputs& inputs, const Positions& x, Workspace& workspace);

// Energy of the contacts at a point, friction included, or its difference from a reference's; adds `sign` times their
// gradient when wanted.
struct ContactChange {
  double value = 0;  // [J]
  double slope = 0;  // along the direction [J]
};
ContactChange add_contacts(const std::vector<Contact>& contacts, double stick_length, const Positions& point,
                           const Positions* reference, const Positions& direction, Positions* gradient,
                           double sign = 1);

}  // namespace supple
