// Computes how much of the sky the bodies hide from the ground below them: the contact shadow that makes a figure
// appear to stand on the ground. It is computed in each frame, on a grid, from the surface's triangles.
#pragma once

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
};

}  // namespace supple
