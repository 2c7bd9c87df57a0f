#include "geometry/triangles/mean_curvature.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace supple {

// The Laplacian of the places is twice the mean curvature along the normal (Meyer, Desbrun, Schroeder and Barr 2003,
// "Discrete differential-geometry operators for triangulated 2-manifolds", equation 8); here with a third of the
// triangles' area for each vertex. Cotangents make it the same for all triangulations.
std::vector<double> mean_curvature(const Positions& points, const Triangles& triangles) {
  Positions laplacian = Positions::Zero(points.rows(), 3), normal = laplacian;
  std::vector<double> area(std::size_t(points.rows()), 0.0);
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const Vec3 corner[3] = {points.row(triangles(t, 0)), points.row(triangles(t, 1)), points.row(triangles(t, 2))};
    const Vec3 face = (corner[1] - corner[0]).cross(corner[2] - corner[0]);
    const double twice_area = face.norm();
    for (int k = 0; k < 3; ++k) {
      const int a = (k + 1) % 3, b = (k + 2) % 3;
      normal.row(triangles(t, k)) += face.transpose();
      area[std::size_t(triangles(t, k))] += twice_area / 6;
      const Vec3 to_a = corner[a] - corner[k], to_b = corner[b] - corner[k];
      if (twice_area <= 1e-6 * to_a.norm() * to_b.norm()) continue;  // a sliver has no angle
      const Vec3 way = to_a.dot(to_b) / twice_area / 2 * (corner[b] - corner[a]);
      laplacian.row(triangles(t, a)) += way.transpose();
      laplacian.row(triangles(t, b)) -= way.transpose();
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
