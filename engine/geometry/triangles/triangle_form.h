// Measures how good a triangle is, for those who change a mesh.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/types.h"

namespace supple {

// Describes a triangle by its area vector [m^2] and the sum of its squared sides [m^2].
struct TriangleForm {
  Vec3 area;
  double squares;

  TriangleForm(const Vec3& a, const Vec3& b, const Vec3& c)
      : area(0.5 * (b - a).cross(c - a)),
        squares((b - a).squaredNorm() + (c - b).squaredNorm() + (a - c).squaredNorm()) {}

  // Returns how good the triangle is on a surface with this unit normal: its shape or 1/4, whichever is less, times the
  // cosine of its tilt, where that is positive. The shape is 1 for equal sides, and near 0 for a sliver. The score is
  // negative where the triangle is turned over, and 0 where it has no area.
  double score(const Vec3& normal) const {
    const double facing = area.dot(normal), size = area.norm();
    if (!(size > 0)) return 0;
    return std::min(4 * std::sqrt(3.0) * facing / squares, facing / (4 * size));
  }
};

// A triangle with a worse score is made only in place of one that is worse still.
inline constexpr double good_score = 0.1;

inline Vec3 unit_or_zero(const Vec3& v) {
  const double length = v.norm();
  return length > 0 ? Vec3(v / length) : Vec3(Vec3::Zero());
}

}  // namespace supple
