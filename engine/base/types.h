// Defines the vocabulary that every folder shares: arrays of points and of indices. Nothing here knows what a point is
// for. Every unit reads this header, so nothing in it computes with Eigen: each unit would have to compile that again.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>

namespace supple {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;

// Holds one row for each vertex, interleaved in memory (x0 y0 z0 x1 ...), so that a vertex shares its cache
// line with the next ones. [m]
using Positions = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

using Triangles =
    Eigen::Matrix<std::int32_t, Eigen::Dynamic, 3, Eigen::RowMajor>;  // vertex indices, anticlockwise from outside
using Tetrahedra = Eigen::Matrix<std::int32_t, Eigen::Dynamic, 4, Eigen::RowMajor>;  // det[x1-x0, x2-x0, x3-x0] > 0

inline constexpr double infinity = std::numeric_limits<double>::infinity();

// Describes an axis-aligned box; it is empty while any lower bound exceeds its upper one.
struct Bounds {
  Vec3 lower = Vec3(1e300, 1e300, 1e300);
  Vec3 upper = Vec3(-1e300, -1e300, -1e300);

  void include(const Vec3& point) {
    lower = lower.cwiseMin(point);
    upper = upper.cwiseMax(point);
  }
  bool empty() const;
  Vec3 extent() const;
  Vec3 center() const;
  double diagonal() const;
};

Bounds bounds_of(const Positions& points);

}  // namespace supple
