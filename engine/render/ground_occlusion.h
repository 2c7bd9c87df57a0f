// Computes how much of the sky the bodies hide from the ground below them: the contact shadow that makes a figure
// appear to stand on the ground. It is computed in each frame, on a grid, from the surface's vertices.
#pragma once

#include <vector>

#include "render/draw_list.h"

namespace supple {

class GroundOcclusion {
 public:
  static constexpr int cells = 128;        // number of cells along each side
  static constexpr float unseen = 0.008f;  // a part of the sky so small that its lack is less than a level

  // Covers a square of the ground around the stage.
  GroundOcclusion(const Bounds& stage, double largest_body);

  // Returns the open sky by cell, from 1 to 0, row by row along z. positions: x y z by vertex, for each mesh.
  const std::vector<float>& compute(const std::vector<DrawMesh>& meshes,
                                    const std::vector<std::vector<float>>& positions);

  double origin_x() const { return origin_x_; }
  double origin_z() const { return origin_z_; }
  double extent() const { return extent_; }
  double reach() const { return reach_; }  // how high a body may be to darken the ground [m]

 private:
  void lower(float x, float y, float z);
  void lower_over_triangle(const float* a, const float* b, const float* c);

  double origin_x_, origin_z_, extent_, reach_;  // [m]
  std::vector<float> lowest_;                    // height of the lowest surface by cell; huge where there is none [m]
  std::vector<float> open_;
};

}  // namespace supple
