#include "sim/contact/touched_surface.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "sim/contact/lagged_friction.h"
#include "sim/contact/reach.h"
#include "sim/contact/usual_depth.h"
#include "sim/model/joined_model.h"

namespace supple {

// Adds a vertex to a stencil, before those with larger numbers.
void TouchedSurface::add_vertex(std::int32_t vertex, double weight, ContactStencil& stencil) const {
  int at = stencil.count++;
  for (; at > 0 && stencil.vertex[at - 1] > vertex; --at) {
    stencil.vertex[at] = stencil.vertex[at - 1];
    stencil.weight[at] = stencil.weight[at - 1];
  }
  stencil.vertex[at] = vertex;
  stencil.weight[at] = weight;
  stencil.free += vertex < model_.free;
}

TouchedSurface::TouchedSurface(const Model& model, const StepInputs& inputs, const Meeting& meeting, const Positions& q,
                               const Positions& y, const Positions& x, const Work& work)
    : model_(model),
      solver_(inputs.solver),
      meeting_(meeting),
      q_(q),
      y_(y),
      x_(x),
      part_(model.parts[meeting.surface]),
      surface_(work.surfaces[meeting.surface]),
      size_(std::min(part_.size, model.parts[meeting.points].size)),
      fall_(model.time_step * model.time_step * inputs.gravity.norm()) {}

std::int32_t TouchedSurface::corner(std::int32_t triangle, int k) const {
  return joined_vertex(part_, surface_.triangles(triangle, k));
}

double TouchedSurface::reach_at(std::int32_t v, double way) const {
  const double freely = ((y_.row(v) - q_.row(v)).transpose() - surface_.carried_freely).norm();
  return reach_of(way + surface_.own_move, std::max(freely + surface_.free_move, fall_));
}

double TouchedSurface::way_into(const Entry& entry, const Vec3& a, const Vec3& b) const {
  Vec3 pace = b - a;
  for (int k = 0; k < 3; ++k) {
    const std::int32_t c = corner(entry.triangle, k);
    pace -= entry.weights[k] * (x_.row(c) - q_.row(c)).transpose();
  }
  return -entry.normal.dot(pace);
}

double TouchedSurface::share_to_impact(const Entry& entry, const Vec3& a, const Vec3& b, double layer) const {
  const double falls = way_into(entry, a, b), allowed = usual_depth(size_) - layer;
  return falls * (1 - entry.share) > allowed ? std::max(0.0, entry.share + allowed / falls) : 1;
}

bool TouchedSurface::is_over_face(const Place& place, const Vec3& p, const Positions& x) const {
  const Vec3 normal = normal_of(place.triangle, x), offset = p - place.point;
  const double above = normal.dot(offset), beside = (offset - above * normal).norm();
  return !normal.isZero(0) && above >= -usual_depth(size_) && beside <= usual_depth(size_);
}

double TouchedSurface::overhang_at(const Place& place) const {
  if (surface_.overhang == 0) return 0;
  double overhang = 0;
  for (int k = 0; k < 3; ++k) overhang += place.weights[k] * model_.overhang_at(corner(place.triangle, k));
  return overhang;
}

Vec3 TouchedSurface::normal_of(std::int32_t triangle, const Positions& x) const {
  const Vec3 first = x.row(corner(triangle, 0)).transpose();
  const Vec3 edge = x.row(corner(triangle, 1)).transpose() - first;
  const Vec3 other = x.row(corner(triangle, 2)).transpose() - first;
  const Vec3 normal = edge.cross(other);
  const double length = normal.norm();
  return length > 0 ? Vec3(normal / length) : Vec3(Vec3::Zero());
}

std::optional<MovingSurface::Place> TouchedSurface::place_at_end(std::int32_t triangle, const Vec3& weights,
                                                                 const Vec3& p) const {
  Place place{triangle, weights, Vec3::Zero(), 0, normal_of(triangle, x_)};
  if (place.normal.isZero(0)) return std::nullopt;
  for (int k = 0; k < 3; ++k) place.point += weights[k] * x_.row(corner(triangle, k)).transpose();
  place.distance = place.normal.dot(p - place.point);
  return place;
}

ContactStencil TouchedSurface::stencil_of(std::int32_t point, const Place& place) const {
  constexpr double least_weight = 1e-9;
  ContactStencil stencil{};
  stencil.count = stencil.free = 0;
  double sum = 0;
  for (int k = 0; k < 3; ++k) {
    if (place.weights[k] < least_weight) continue;
    add_vertex(corner(place.triangle, k), -place.weights[k], stencil);
    sum += place.weights[k];
  }
  add_vertex(point, sum, stencil);
  return stencil;
}

void TouchedSurface::add(std::int32_t v, const Place& place, double field, std::vector<Contact>& list,
                         double layer) const {
  add(stencil_of(v, place), v, place.normal, field, list, layer);
}

void TouchedSurface::add(const ContactStencil& stencil, std::int32_t number, const Vec3& normal, double field,
                         std::vector<Contact>& list, double layer) const {
  Contact contact{stencil, {-1, meeting_.surface}, normal, 0, 0, 0, number};
  if (contact.stencil.free == 0) return;
  const double h = model_.time_step, mass = contact.stencil.mass(model_.mass);
  const double fastest = solver_.contact.push_out * size_ * h;
  const double deep = std::max(0.0, -field - fastest);
  contact.offset = layer - deep;
  contact.stiffness = solver_.contact.stiffness / (h * h) * mass;
  contact.depth = std::max(0.0, -gap(contact, x_));
  contact.origin = contact.stencil.at(q_);
  if (meeting_.friction > 0) {
    contact.stick = solver_.contact.stick * size_ * h;
    begin_friction(meeting_.friction, deep > 0 ? 0 : -field, -gap(contact, y_), model_.scheme.inertia * mass / (h * h),
                   contact);
  }
  list.push_back(contact);
}

std::vector<char> only_sharp_points(const Model& model, const StepInputs& inputs, const SurfaceWork::Parts& work) {
  std::vector<std::pair<std::int32_t, std::int32_t>> pairs;
  for (const Meeting& meeting : inputs.meetings) pairs.emplace_back(meeting.points, meeting.surface);
  std::ranges::sort(pairs);
  std::vector<char> only_sharp;
  for (const Meeting& meeting : inputs.meetings) {
    const bool both_ways = std::ranges::binary_search(pairs, std::pair(meeting.surface, meeting.points));
    const bool is_solid = model.parts[meeting.points].solid;
    const double own = work.surfaces[meeting.points].edge, other = work.surfaces[meeting.surface].edge;
    const bool is_coarser = own > other || (own == other && meeting.points > meeting.surface);
    only_sharp.push_back(both_ways && is_solid && is_coarser);
  }
  return only_sharp;
}

// The boxes are compared in the frame that moves with the surface.
bool are_apart(const Model& model, const StepInputs& inputs, const Meeting& meeting, const SurfaceWork::Parts& work) {
  const SurfaceWork::Parts::Surface &own = work.surfaces[meeting.points], &other = work.surfaces[meeting.surface];
  if (own.moving == nullptr) return false;
  const auto swept = [&](const MovingSurface& moving) {
    Bounds box = moving.bounds_at_start();
    box.include(moving.bounds_at_end().lower - other.carried);
    box.include(moving.bounds_at_end().upper - other.carried);
    return box;
  };
  const double way = own.own_move + (own.carried - other.carried).norm();
  const double freely = own.free_move + (own.carried_freely - other.carried_freely).norm();
  const double fall = model.time_step * model.time_step * inputs.gravity.norm();
  const double reach = (1 + 1e-6) * reach_of(way + other.own_move, std::max(freely + other.free_move, fall)) +
                       own.layer + other.layer + own.overhang + other.overhang;
  const Bounds one = swept(*own.moving), two = swept(*other.moving);
  return ((one.lower.array() - reach > two.upper.array()) || (two.lower.array() - reach > one.upper.array())).any();
}

}  // namespace supple
