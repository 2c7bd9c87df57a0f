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

const std::vector<float>& GroundOcclusion::compute(const std::vector<std::vector<float>>& positions) {
  const double cell = extent_ / cells;
  std::fill(lowest_.begin(), lowest_.end(), 1e9f);
  for (const std::vector<float>& points : positions) {
    for (std::size_t i = 0; i + 2 < points.size(); i += 3) {
      const double u = (points[i] - origin_x_) / cell, v = (points[i + 2] - origin_z_) / cell;
      if (!(u >= 0 && v >= 0 && u < cells && v < cells)) continue;
      float& low = lowest_[std::size_t(v) * cells + std::size_t(u)];
      low = std::min(low, std::max(points[i + 1], static_cast<float>(0.35 * cell)));
    }
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
