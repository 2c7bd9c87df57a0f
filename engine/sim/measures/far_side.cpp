#include "sim/measures/far_side.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "base/disjoint_sets.h"
#include "geometry/shapes/shape_probe.h"

namespace supple {
namespace {

// Examines a plate in its own frame, and the ways of a body's surface near it.
class Plate {
 public:
  Plate(const Shape& shape, double half_thickness)
      : probe_(shape), certainty_(shape.certainty()), least_step_(0.25 * half_thickness) {}

  SurfacePoint closest(const Vec3& p) { return probe_.closest(p, near_); }

  // Tells whether the straight way between two vertices leads through the plate from one side to the other. An edge
  // does not count where it only cuts short a way around the rim: where a place beside the edge, no further away than
  // its length, is reached freely from both ends.
  bool divides(const SurfacePoint& at_a, const SurfacePoint& at_b, const Vec3& a, const Vec3& b) {
    const double length = (b - a).norm();
    if (at_a.normal.dot(at_b.normal) > 0) return false;
    if (certainty_ * (std::max(0.0, at_a.distance) + std::max(0.0, at_b.distance)) > length) return false;
    const Vec3 from = outside(at_a, a), to = outside(at_b, b);
    const std::optional<Vec3> inside = first_inside(from, to);
    return inside && !leads_around(from, to, *inside, length);
  }

 private:
  // Returns a vertex, or a place a little above the surface where the vertex touches it or is inside.
  Vec3 outside(const SurfacePoint& at, const Vec3& vertex) const {
    return at.distance > least_step_ ? vertex : Vec3(at.point + least_step_ * at.normal);
  }

  // Returns the first place on the way that is inside the plate, by sphere tracing.
  std::optional<Vec3> first_inside(const Vec3& from, const Vec3& to) {
    const double length = (to - from).norm();
    const Vec3 way = (to - from) / std::max(length, 1e-300);
    for (double gone = 0; gone < length;) {
      const Vec3 place = from + gone * way;
      const double distance = probe_.distance(place, near_);
      if (distance < 0) return place;
      gone += std::max(certainty_ * distance, least_step_);
    }
    return std::nullopt;
  }

  // Tells whether some place around the one inside is reached freely from both ends. Places are tried in the directions
  // of a cube's faces, edges and corners.
  bool leads_around(const Vec3& from, const Vec3& to, const Vec3& inside, double length) {
    for (const double share : {0.25, 0.5, 1.0}) {
      for (int i = 0; i < 27; ++i) {
        const Vec3 direction(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
        const Vec3 beside = inside + share * length * direction.normalized();
        if (!first_inside(from, beside) && !first_inside(to, beside)) return true;
      }
    }
    return false;
  }

  ShapeProbe probe_;
  QueryMemory near_;
  double certainty_, least_step_;  // [m]
};

double longest_edge(const Triangles& triangles, const Positions& x) {
  double longest = 0;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k)
      longest = std::max(longest, (x.row(triangles(t, k)) - x.row(triangles(t, (k + 1) % 3))).squaredNorm());
  }
  return std::sqrt(longest);
}

// Tells which vertices are within a distance of a box.
std::vector<char> vertices_near(const Bounds& box, double distance, const Positions& x) {
  std::vector<char> near(std::size_t(x.rows()), 0);
  for (Eigen::Index v = 0; v < x.rows(); ++v) {
    const Vec3 p = x.row(v).transpose();
    near[v] = (p.array() >= box.lower.array() - distance).all() && (p.array() <= box.upper.array() + distance).all();
  }
  return near;
}

}  // namespace

double reach_on_far_side(const Model& model, const Collider& collider, const Eigen::Isometry3d& pose,
                         const Positions& x) {
  const double half_thickness = collider.shape.usual_half_thickness();
  if (half_thickness <= 0 || half_thickness > thin_half_thickness * model.size) return 0;
  const Positions local = (x * pose.linear()).rowwise() - (pose.linear().transpose() * pose.translation()).transpose();
  const std::vector<char> near = vertices_near(collider.shape.bounds(), longest_edge(model.surface, x), local);
  if (std::ranges::find(near, 1) == near.end()) return 0;

  Plate plate(collider.shape, half_thickness);
  std::vector<std::optional<SurfacePoint>> closest(near.size());  // by vertex, once it is asked for
  const auto place = [&](int v) { return Vec3(local.row(v).transpose()); };
  const auto closest_to = [&](int v) -> const SurfacePoint& {
    if (!closest[v]) closest[v] = plate.closest(place(v));
    return *closest[v];
  };
  DisjointSets parts(std::size_t(model.vertices));  // vertices joined by edges that pass through nothing
  std::vector<std::array<int, 2>> cut;
  for (Eigen::Index t = 0; t < model.surface.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int a = model.surface(t, k), b = model.surface(t, (k + 1) % 3);
      if (near[a] != 0 && near[b] != 0 && plate.divides(closest_to(a), closest_to(b), place(a), place(b))) {
        cut.push_back({a, b});
      } else {
        parts.join(std::size_t(a), std::size_t(b));
      }
    }
  }
  if (cut.empty()) return 0;

  std::vector<int> size(near.size(), 0);  // number of vertices in the part that a vertex stands for
  for (int v = 0; v < model.vertices; ++v) ++size[parts.of(std::size_t(v))];
  std::vector<char> is_far(near.size(), 0);
  for (const auto& [a, b] : cut) {
    const std::size_t one = parts.of(std::size_t(a)), other = parts.of(std::size_t(b));
    if (one != other) is_far[size[one] < size[other] ? one : other] = 1;
  }
  double furthest = 0;
  for (int v = 0; v < model.vertices; ++v)
    if (is_far[parts.of(std::size_t(v))] != 0) furthest = std::max(furthest, closest_to(v).distance);
  return furthest;
}

}  // namespace supple
