#include "geometry/shapes/rounded_prism.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/convex_hull.h"
#include "base/error.h"

namespace supple {
namespace {

constexpr double finest_turn = std::numbers::pi / 12;  // the largest angle between neighbouring normals [rad]
constexpr int bevel_steps = 6;

// Describes a place on the outline of the hull, and the direction that points away from the hull there.
struct OutlinePoint {
  Eigen::Vector2d place, normal;
};

// Lists places around the hull, anticlockwise. At a corner, the normal turns in small steps.
std::vector<OutlinePoint> outline_of(const std::vector<Eigen::Vector2d>& hull) {
  const std::size_t corners = hull.size();
  const auto normal_angle = [&](std::size_t i) {  // of the edge that begins at a corner
    const Eigen::Vector2d along = hull[(i + 1) % corners] - hull[i % corners];
    return std::atan2(-along.x(), along.y());
  };
  std::vector<OutlinePoint> outline;
  for (std::size_t i = 0; i < corners; ++i) {
    const double from = corners > 1 ? normal_angle(i + corners - 1) : 0;
    double turn = corners > 1 ? normal_angle(i) - from : 2 * std::numbers::pi;
    if (turn < 0) turn += 2 * std::numbers::pi;
    const int steps = std::max(1, static_cast<int>(std::ceil(turn / finest_turn - 1e-9)));
    const int last = corners > 1 ? steps : steps - 1;  // the outline of a point closes by itself
    for (int k = 0; k <= last; ++k) {
      const double angle = from + turn * k / steps;
      outline.push_back({hull[i], {std::cos(angle), std::sin(angle)}});
    }
  }
  return outline;
}

// Describes a ring of vertices: how far it lies from the hull, and how high.
struct Ring {
  double away, height;
};

std::vector<Ring> rings_of(const RoundedPrism& prism) {
  std::vector<Ring> rings;
  const int steps = prism.bevel > 0 ? bevel_steps : 0;
  for (const bool upper : {false, true}) {
    for (int k = 0; k <= steps; ++k) {
      const int step = upper ? steps - k : k;
      const double angle = 0.5 * std::numbers::pi * step / std::max(1, steps);
      const double away = prism.margin - prism.bevel * (1 - std::sin(angle));
      const double in = prism.bevel * (1 - std::cos(angle));
      rings.push_back({steps > 0 ? away : prism.margin, upper ? prism.high - in : prism.low + in});
    }
  }
  return rings;
}

}  // namespace

TriMesh surface_of(const RoundedPrism& prism) {
  SUPPLE_CHECK(prism.bevel, <=, prism.margin * (1 + 1e-9));
  std::vector<Eigen::Vector2d> hull = hull_of(prism.points);
  hull.erase(std::unique(hull.begin(), hull.end()), hull.end());  // the hull of equal points
  const std::vector<OutlinePoint> outline = outline_of(hull);
  const std::vector<Ring> rings = rings_of(prism);
  const auto around = static_cast<Eigen::Index>(outline.size()), levels = static_cast<Eigen::Index>(rings.size());
  TriMesh mesh;
  mesh.points.resize(levels * around + 2, 3);
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& corner : hull) middle += corner / static_cast<double>(hull.size());
  for (Eigen::Index r = 0; r < levels; ++r) {
    for (Eigen::Index i = 0; i < around; ++i) {
      const Eigen::Vector2d at = outline[i].place + rings[r].away * outline[i].normal;
      mesh.points.row(r * around + i) << at.x(), at.y(), rings[r].height;
    }
  }
  const Eigen::Index bottom = levels * around, top = bottom + 1;
  mesh.points.row(bottom) << middle.x(), middle.y(), prism.low;
  mesh.points.row(top) << middle.x(), middle.y(), prism.high;
  std::vector<std::array<Eigen::Index, 3>> triangles;
  const double largest = bounds_of(mesh.points).diagonal();
  const auto add = [&](Eigen::Index a, Eigen::Index b, Eigen::Index c) {
    const Vec3 p = mesh.points.row(a), q = mesh.points.row(b), r = mesh.points.row(c);
    const bool has_area = (q - p).cross(r - p).norm() > 1e-12 * largest * largest;  // false at the poles of a ball
    if (has_area) triangles.push_back({a, b, c});
  };
  for (Eigen::Index i = 0; i < around; ++i) {
    const Eigen::Index next = (i + 1) % around;
    add(bottom, next, i);
    for (Eigen::Index r = 0; r + 1 < levels; ++r) {
      const Eigen::Index low = r * around, high = low + around;
      add(low + i, low + next, high + next);
      add(low + i, high + next, high + i);
    }
    add(top, (levels - 1) * around + i, (levels - 1) * around + next);
  }
  mesh.triangles.resize(static_cast<Eigen::Index>(triangles.size()), 3);
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k)
      mesh.triangles(static_cast<Eigen::Index>(t), k) = static_cast<std::int32_t>(triangles[t][k]);
  }
  return mesh;
}

}  // namespace supple
