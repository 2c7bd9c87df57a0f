// Defines the vocabulary that every folder shares: arrays of points and of indices. Nothing here knows what a point is
// for.
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace supple {

using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;

// Holds one row for each vertex, interleaved in memory (x0 y0 z0 x1 ...), so that a vertex shares its cache
// line with the next ones. [m]
using Positions = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;

using Triangles =
    Eigen::Matrix<std::int32_t, Eigen::Dynamic, 3, Eigen::RowMajor>;  // vertex indices, anticlockwise from outside
using Tetrahedra = Eigen::Matrix<std::int32_t, Eigen::Dynamic, 4, Eigen::RowMajor>;  // det[x1-x0, x2-x0, x3-x0] > 0

// An axis-aligned box; it is empty while any lower bound exceeds its upper one.
struct Bounds {
  Vec3 lower = Vec3::Constant(1e300);
  Vec3 upper = Vec3::Constant(-1e300);

  void include(const Vec3& point) {
    lower = lower.cwiseMin(point);
    upper = upper.cwiseMax(point);
  }
  bool empty() const { return (lower.array() > upper.array()).any(); }
  Vec3 extent() const { return empty() ? Vec3(Vec3::Zero()) : Vec3(upper - lower); }
  Vec3 center() const { return 0.5 * (lower + upper); }
  double diagonal() const { return extent().norm(); }
};

inline Bounds bounds_of(const Positions& points) {
  Bounds box;
  for (Eigen::Index i = 0; i < points.rows(); ++i) box.include(points.row(i).transpose());
  return box;
}

}  // namespace supple
