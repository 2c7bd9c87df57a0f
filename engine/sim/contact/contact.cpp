#include "sim/contact/contact.h"

#include <algorithm>
#include <cmath>

#include "sim/contact/lagged_friction.h"

namespace supple {
namespace {

// Computes the potential of smoothed friction: u - s/3 above the sliding length s, and below it a cubic that joins with
// its first two derivatives (Li et al. 2020, "Incremental potential contact", section 5.2, up to a constant).
double friction_potential(double u, double s) { return u >= s ? u - s / 3 : u * u / s * (1 - u / (3 * s)); }
double friction_slope_over_u(double u, double s) { return u >= s ? 1 / u : (2 - u / s) / s; }

// Returns how far a point has slid along its plane since the step began.
Vec3 slip(const Contact& contact, const Vec3& x) {
  const Vec3 moved = x - contact.origin;
  return moved - moved.dot(contact.normal) * contact.normal;
}

}  // namespace

int renew_contacts(const Positions& x, std::vector<Contact>& contacts) {
  int changes = 0;
  for (Contact& contact : contacts) {
    const bool touched = contact.depth > 0;
    contact.depth = std::max(0.0, -gap(contact, x));
    changes += touched != (contact.depth > 0);
    renew_friction(contact);
  }
  return changes;
}

double friction_energy(const std::vector<Contact>& contacts, const Positions& point) {
  double sum = 0;
  for (const Contact& contact : contacts) {
    if (contact.friction > 0)
      sum += contact.friction * friction_potential(slip(contact, contact.stencil.at(point)).norm(), contact.stick);
  }
  return sum;
}

double friction_stiffness(const Contact& contact, const Positions& x) {
  return contact.friction * friction_slope_over_u(slip(contact, contact.stencil.at(x)).norm(), contact.stick);
}

double contact_energy(const std::vector<Contact>& contacts, const Positions& point) {
  double sum = 0;
  for (const Contact& contact : contacts) {
    const double below = std::min(0.0, gap(contact, point));
    sum += contact.stiffness * below * below;
  }
  return sum;
}

void add_forces(const std::vector<Contact>& contacts, const Positions& point, std::vector<Vec3>& by_collider) {
  for (const Contact& contact : contacts) {
    if (!contact.other.is_collider()) continue;
    const Vec3 p = contact.stencil.at(point);
    const double below = std::min(0.0, contact.normal.dot(p) - contact.offset);
    by_collider[contact.other.collider] -= 2 * contact.stiffness * below * contact.normal;
    if (contact.friction <= 0) continue;
    const Vec3 slid = slip(contact, p);
    by_collider[contact.other.collider] -= contact.friction * friction_slope_over_u(slid.norm(), contact.stick) * slid;
  }
}

ContactChange add_contacts(const std::vector<Contact>& contacts, const Positions& point, const Positions* reference,
                           const Positions& direction, Positions* gradient, double sign) {
  ContactChange change;
  for (const Contact& contact : contacts) {
    const Vec3 p = contact.stencil.at(point), before = reference != nullptr ? contact.stencil.at(*reference) : p;
    const double below = std::min(0.0, contact.normal.dot(p) - contact.offset);
    const double below_before = reference != nullptr ? std::min(0.0, contact.normal.dot(before) - contact.offset) : 0;
    if (below == 0 && below_before == 0 && contact.friction == 0) continue;
    change.value += contact.stiffness * (below - below_before) * (below + below_before);
    Vec3 slope = 2 * contact.stiffness * below * contact.normal;
    if (contact.friction > 0) {
      const Vec3 slid = slip(contact, p);
      const double u = slid.norm();
      change.value += contact.friction * friction_potential(u, contact.stick);
      if (reference != nullptr)
        change.value -= contact.friction * friction_potential(slip(contact, before).norm(), contact.stick);
      slope += contact.friction * friction_slope_over_u(u, contact.stick) * slid;
    }
    if (gradient == nullptr) continue;
    contact.stencil.spread(sign * slope, *gradient);
    change.slope += slope.dot(contact.stencil.of_free(direction));
  }
  return change;
}

}  // namespace supple
