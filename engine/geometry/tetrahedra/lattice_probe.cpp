#include "geometry/tetrahedra/lattice_probe.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace supple {
namespace {

constexpr double empty_field = 1e9;  // of a group without parts, as in Shape::distance

bool has_open_surface(const ShapeGroup& group) {
  return std::any_of(group.parts.begin(), group.parts.end(), [](const ShapePart& part) {
    if (const auto* inner = std::get_if<ShapeGroup>(&part.primitive)) return has_open_surface(*inner);
    const auto* surface = std::get_if<ClosedSurface>(&part.primitive);
    return surface != nullptr && !surface->solid->is_closed();
  });
}

}  // namespace

LatticeProbe::LatticeProbe(const Shape& shape, double swell)
    : shape_(shape), swell_(swell), certainty_(has_open_surface(shape.root) ? 0 : shape.certainty()) {
  const auto is_plain_surface = [](const ShapePart& part) {
    return std::holds_alternative<ClosedSurface>(part.primitive) && part.combine == Combine::add && !part.mirror_x;
  };
  if (!std::all_of(shape.root.parts.begin(), shape.root.parts.end(), is_plain_surface)) return;
  for (const ShapePart& part : shape.root.parts) surfaces_.push_back(&part);
}

double LatticeProbe::distance(const Vec3& p, Memory& near) const {
  if (surfaces_.empty()) return shape_.distance(p) - swell_;
  double field = empty_field;
  for (std::size_t s = 0; s < surfaces_.size(); ++s) {
    const ShapePart& part = *surfaces_[s];
    // A part that is further away than the others by more than the blend's width does not change their field.
    const Bounds& box = solid(s).bounds();
    const Vec3 place = local(s, p);
    const double to_box = part.scale * (box.lower - place).cwiseMax(place - box.upper).cwiseMax(0).norm();
    if (0.999 * to_box > field + part.blend) continue;
    field = smooth_min(field, part.scale * solid(s).closest(place, near[s]).distance, part.blend).value;
  }
  return field - swell_;
}

// Keeps the parts that matter on the way. The distances at its start bound those on it, so that a part is left out
// where the field of those before it, or the distance of one after it, is certainly smaller by more than the blend's
// width.
LatticeProbe::Way::Way(const LatticeProbe& probe, const Vec3& start, double length, Memory& near)
    : probe_(probe), near_(near) {
  const std::size_t count = probe.surfaces_.size();
  if (count == 1) surfaces_.push_back({0, {}});
  if (count < 2) return;
  const double reach = 1.001 * length;
  double low = empty_field, high = empty_field;  // bounds of the field so far
  for (std::size_t s = 0; s < count; ++s) {
    const ShapePart& part = *probe.surfaces_[s];
    const double here = part.scale * probe.solid(s).closest(probe.local(s, start), near[s]).distance;
    if (here - reach > high + part.blend) continue;
    if (here + reach < low - part.blend) surfaces_.clear();
    surfaces_.push_back({s, {}});
    low = smooth_min(low, here - reach, part.blend).value;
    high = smooth_min(high, here + reach, part.blend).value;
  }
}

double LatticeProbe::Way::of_surface(Surface& surface, const Vec3& p, double ahead) {
  const ShapePart& part = *probe_.surfaces_[surface.number];
  const TriangleSolid& solid = probe_.solid(surface.number);
  const Vec3 place = probe_.local(surface.number, p);
  if (surface.leaves.count > 0) return part.scale * solid.distance_among(place, surface.leaves);
  const double distance = solid.closest(place, near_[surface.number]).distance;
  solid.find_leaves(place, std::abs(distance) + ahead / part.scale, surface.leaves);
  return part.scale * distance;
}

double LatticeProbe::Way::distance(const Vec3& p, double ahead) {
  if (surfaces_.empty()) return probe_.shape_.distance(p) - probe_.swell_;
  double field = empty_field;
  for (Surface& surface : surfaces_)
    field = smooth_min(field, of_surface(surface, p, ahead), probe_.surfaces_[surface.number]->blend).value;
  return field - probe_.swell_;
}

}  // namespace supple
