#include "geometry/triangles/mean_curvature.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace supple {

namespace {

// Returns a corner's share of a triangle: the part that is nearest to it, and a simpler one in a triangle with an
// obtuse angle (Meyer et al. 2003, section 3.3). cotangent: of the three angles. length2: squares of the sides opposite
// to them.
double share_of(int corner, const Vec3& cotangent, const Vec3& length2, double area) {
  if (cotangent.minCoeff() < 0) return cotangent[corner] < 0 ? area / 2 : area / 4;
  const int a = (corner + 1) % 3, b = (corner + 2) % 3;
  return (cotangent[a] * length2[a] + cotangent[b] * length2[b]) / 8;
}

}  // namespace

// The Laplacian of the places is twice the mean curvature along the normal (Meyer, Desbrun, Schroeder and Barr 2003,
// "Discrete differential-geometry operators for triangulated 2-manifolds", equation 8). With these cotangents and areas
// it is the same for all triangulations.
std::vector<double> mean_curvature(const Positions& points, const Triangles& triangles) {
  Positions laplacian = Positions::Zero(points.rows(), 3), normal = laplacian;
  std::vector<double> area(std::size_t(points.rows()), 0.0);
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const Vec3 corner[3] = {points.row(triangles(t, 0)), points.row(triangles(t, 1)), points.row(triangles(t, 2))};
    const Vec3 side[3] = {corner[2] - corner[1], corner[0] - corner[2], corner[1] - corner[0]};  // opposite
    const Vec3 face = side[0].cross(side[1]);
    const double twice_area = face.norm();
    const Vec3 length2(side[0].squaredNorm(), side[1].squaredNorm(), side[2].squaredNorm());
    if (twice_area <= 1e-6 * length2.maxCoeff()) continue;  // a sliver has no angles
    const Vec3 cotangent = -Vec3(side[1].dot(side[2]), side[2].dot(side[0]), side[0].dot(side[1])) / twice_area;
    for (int k = 0; k < 3; ++k) {
      normal.row(triangles(t, k)) += face.transpose();
      area[std::size_t(triangles(t, k))] += share_of(k, cotangent, length2, twice_area / 2);
      const Vec3 way = cotangent[k] / 2 * side[k];
      laplacian.row(triangles(t, (k + 1) % 3)) += way.transpose();
      laplacian.row(triangles(t, (k + 2) % 3)) -= way.transpose();
    }
  }
  std::vector<double> curvature;
  for (Eigen::Index v = 0; v < points.rows(); ++v) {
    const double size = area[std::size_t(v)] * normal.row(v).norm();
    curvature.push_back(size > 0 ? laplacian.row(v).dot(normal.row(v)) / (2 * size) : 0);
  }
  return curvature;
}

void smooth_values(const Triangles& triangles, int rounds, std::vector<double>& values) {
  std::vector<double> sum(values.size());
  std::vector<int> count(values.size());
  for (int round = 0; round < rounds; ++round) {
    std::ranges::fill(sum, 0);
    std::ranges::fill(count, 0);
    for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
      for (int k = 0; k < 3; ++k) {
        sum[std::size_t(triangles(t, k))] +=
            values[std::size_t(triangles(t, (k + 1) % 3))] + values[std::size_t(triangles(t, (k + 2) % 3))];
        count[std::size_t(triangles(t, k))] += 2;
      }
    }
    for (std::size_t v = 0; v < values.size(); ++v) {
      if (count[v] > 0) values[v] = (values[v] + sum[v] / count[v]) / 2;
    }
  }
}

}  // namespace supple
