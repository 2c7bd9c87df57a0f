// Computes how much of the sky the bodies hide from the ground below them: the contact shadow that makes a figure
// appear to stand on the ground. It is computed in each frame, on a grid, from the surface's triangles.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "render/draw_list.h"

namespace supple {

class GroundOcclusion {
 public:
  static constexpr int cells = 128;        // number of cells along each side
  static constexpr float unseen = 0.008f;  // a part of the sky so small that its lack is less than a level

  explicit GroundOcclusion(double largest_body);

  // Returns the open sky by cell, from 1 to 0, row by row along z, in a square of the ground. positions: x y z by
  // vertex, for each mesh. center, extent: of the square [m].
  const std::vector<float>& compute(const std::vector<DrawMesh>& meshes,
                                    const std::vector<std::vector<float>>& positions, const Vec3& center,
                                    double extent);

  // Returns the open sky over places of the ground [m], so smooth that cells do not show, and 1 beyond the square.
  // Takes what the last call of smooth() found.
  template <class Lanes>
  Lanes at(const Lanes& x, const Lanes& z) const;
  // Smooths what compute() found, for at().
  void smooth();

  double origin_x() const { return origin_x_; }
  double origin_z() const { return origin_z_; }
  double extent() const { return extent_; }
  double reach() const { return reach_; }  // how high a body may be to darken the ground [m]

 private:
  // Holds what is above a cell: the area of the surface [m^2], and the sum of areas times heights [m^3].
  struct Cover {
    float area = 0, height = 0;
  };
  void cover(float x, float y, float z, float area);
  void cover_by_triangle(const float* a, const float* b, const float* c, bool two_sided);

  double origin_x_ = 0, origin_z_ = 0, extent_ = 1, reach_;  // [m]
  float by_cell_ = 1, first_u_ = 0, first_v_ = 0;            // 1 over a cell's edge [1/m]; the first centre, in cells
  std::vector<Cover> covers_;                                // by cell
  std::vector<float> open_;
  static constexpr int nodes = 2 * cells;
  std::vector<float> between_, smooth_;  // by node, two for each cell, and by cell and node
};

template <class Lanes>
Lanes GroundOcclusion::at(const Lanes& x, const Lanes& z) const {
  const auto by_node = 2 * by_cell_;
  const auto last = static_cast<float>(nodes) - 1.001f;
  const Lanes u = ((x - static_cast<float>(origin_x_)) * by_node - 1).max(0.0f).min(last);
  const Lanes v = ((z - static_cast<float>(origin_z_)) * by_node - 1).max(0.0f).min(last);
  Lanes result;
  for (Eigen::Index k = 0; k < result.size(); ++k) {
    const float across = u[k] > 0 ? u[k] : 0, along = v[k] > 0 ? v[k] : 0;  // 0 for what is not a number
    const auto i = static_cast<int>(across), j = static_cast<int>(along);
    const float s = across - static_cast<float>(i), t = along - static_cast<float>(j);
    const float* low = &smooth_[std::size_t(j) * nodes + std::size_t(i)];
    const float* high = low + nodes;
    const float below = low[0] + s * (low[1] - low[0]), above = high[0] + s * (high[1] - high[0]);
    result[k] = below + t * (above - below);
  }
  return result;
}

}  // namespace supple
