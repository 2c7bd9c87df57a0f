#include "render/ground_occlusion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace supple {

GroundOcclusion::GroundOcclusion(const Bounds& stage, double largest_body)
    : reach_(0.6 * largest_body), lowest_(cells * cells), open_(cells * cells) {
  extent_ = std::max(stage.extent().x(), stage.extent().z()) + 2.5 * largest_body;
  origin_x_ = stage.center().x() - 0.5 * extent_;
  origin_z_ = stage.center().z() - 0.5 * extent_;
}

// Records that there is a surface at a point.
void GroundOcclusion::lower(float x, float y, float z) {
  if (y > reach_) return;
  const double cell = extent_ / cells, by_cell = cells / extent_;
  const double u = (x - origin_x_) * by_cell, v = (z - origin_z_) * by_cell;
  if (!(u >= 0 && v >= 0 && u < cells && v < cells)) return;
  float& low = lowest_[std::size_t(v) * cells + std::size_t(u)];
  low = std::min(low, std::max(y, static_cast<float>(0.35 * cell)));
}

// Does the same for points of a triangle that are less than a cell apart. The corners of a small triangle are enough,
// and they have been recorded already.
void GroundOcclusion::lower_over_triangle(const float* a, const float* b, const float* c) {
  const auto span = [](float p, float q, float r) { return std::max({p, q, r}) - std::min({p, q, r}); };
  const double cell = extent_ / cells;
  const double widest = std::max(span(a[0], b[0], c[0]), span(a[2], b[2], c[2]));
  if (widest < cell || std::min({a[1], b[1], c[1]}) > reach_) return;
  const int parts = std::min(static_cast<int>(std::ceil(widest / cell)), 2 * cells);
  for (int i = 0; i <= parts; ++i) {
    for (int k = 0; k <= parts - i; ++k) {
      const float s = static_cast<float>(i) / static_cast<float>(parts),
                  t = static_cast<float>(k) / static_cast<float>(parts);
      lower(a[0] + s * (b[0] - a[0]) + t * (c[0] - a[0]), a[1] + s * (b[1] - a[1]) + t * (c[1] - a[1]),
            a[2] + s * (b[2] - a[2]) + t * (c[2] - a[2]));
    }
  }
}

const std::vector<float>& GroundOcclusion::compute(const std::vector<DrawMesh>& meshes,
                                                   const std::vector<std::vector<float>>& positions) {
  const double cell = extent_ / cells;
  std::fill(lowest_.begin(), lowest_.end(), 1e9f);
  for (std::size_t m = 0; m < positions.size(); ++m) {
    if (meshes[m].ghost) continue;
    const std::vector<float>& points = positions[m];
    for (std::size_t i = 0; i + 2 < points.size(); i += 3) lower(points[i], points[i + 1], points[i + 2]);
    const std::vector<std::uint32_t>& triangles = meshes[m].triangles;
    for (std::size_t t = 0; t + 2 < triangles.size(); t += 3)
      lower_over_triangle(&points[3 * triangles[t]], &points[3 * triangles[t + 1]], &points[3 * triangles[t + 2]]);
  }
  // A patch at height y, seen from a point at distance d beside it, covers this share of the sky: y^2 dA / (pi (d^2 +
  // y^2)^2).
  std::fill(open_.begin(), open_.end(), 1.0f);
  const int radius = std::max(1, static_cast<int>(reach_ / cell));
  const auto patch = static_cast<float>(cell * cell / std::numbers::pi);
  for (int j = 0; j < cells; ++j) {
    for (int i = 0; i < cells; ++i) {
      const float y = lowest_[std::size_t(j) * cells + i];
      if (y > reach_) continue;
      for (int v = std::max(0, j - radius); v <= std::min(cells - 1, j + radius); ++v) {
        for (int u = std::max(0, i - radius); u <= std::min(cells - 1, i + radius); ++u) {
          const auto d2 = static_cast<float>(((u - i) * (u - i) + (v - j) * (v - j)) * cell * cell);
          const float s = d2 + y * y;
          open_[std::size_t(v) * cells + u] -= y * y * patch / (s * s);
        }
      }
    }
  }
  for (float& value : open_) value = std::max(value, 0.0f);
  return open_;
}

}  // namespace supple
