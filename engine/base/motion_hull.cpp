#include "base/motion_hull.h"

#include <cmath>
#include <limits>
#include <numbers>

namespace supple {
namespace {

constexpr int spiral_directions = 400;

// Returns directions that lie evenly on the sphere, along a spiral from pole to pole, and the six along the axes.
const std::vector<Vec3>& directions() {
  static const std::vector<Vec3> all = [] {
    std::vector<Vec3> made;
    const double turn = std::numbers::pi * (3 - std::sqrt(5.0));
    for (int i = 0; i < spiral_directions; ++i) {
      const double y = 1 - (2 * i + 1.0) / spiral_directions, radius = std::sqrt(1 - y * y);
      made.emplace_back(radius * std::cos(turn * i), y, radius * std::sin(turn * i));
    }
    for (int axis = 0; axis < 3; ++axis)
      for (const double sign : {-1.0, 1.0}) made.emplace_back(sign * Vec3::Unit(axis));
    return made;
  }();
  return all;
}

}  // namespace

void MotionHull::include(const Vec3& point) {
  const std::vector<Vec3>& along = directions();
  furthest_.resize(along.size());
  reach_.resize(along.size(), -std::numeric_limits<double>::infinity());
  for (std::size_t d = 0; d < along.size(); ++d) {
    const double reach = along[d].dot(point);
    if (reach <= reach_[d]) continue;
    reach_[d] = reach;
    furthest_[d] = point;
  }
}

void MotionHull::include(const Positions& points) {
  for (Eigen::Index i = 0; i < points.rows(); ++i) include(Vec3(points.row(i)));
}

std::vector<Vec3> MotionHull::points() const {
  std::vector<Vec3> unique;
  for (const Vec3& point : furthest_) {
    bool known = false;
    for (const Vec3& other : unique) known = known || other == point;
    if (!known) unique.push_back(point);
  }
  return unique;
}

std::vector<Vec3> corners_of(const Bounds& box) {
  std::vector<Vec3> corners;
  for (int c = 0; c < 8 && !box.empty(); ++c)
    corners.emplace_back(c & 1 ? box.upper.x() : box.lower.x(), c & 2 ? box.upper.y() : box.lower.y(),
                         c & 4 ? box.upper.z() : box.lower.z());
  return corners;
}

Bounds box_around(std::span<const Vec3> points) {
  Bounds box;
  for (const Vec3& point : points) box.include(point);
  return box;
}

}  // namespace supple
