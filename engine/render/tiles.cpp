#include "render/tiles.h"

#include <algorithm>
#include <cmath>

namespace supple {

Tiles::Tiles(int width, int height)
    : width_(width),
      height_(height),
      columns_((width + edge - 1) / edge),
      rows_((height + edge - 1) / edge),
      marked_(std::size_t(columns_) * rows_) {}

void Tiles::clear() { std::ranges::fill(marked_, std::uint8_t{0}); }

void Tiles::mark(const std::vector<float>& positions, const std::vector<std::uint32_t>& triangles,
                 const Eigen::Matrix4f& view) {
  tile_of_.resize(positions.size() / 3 * 2);
  const float across = 0.5f * static_cast<float>(width_) / edge, up = 0.5f * static_cast<float>(height_) / edge;
  bool behind = false;
  // One tile beside the picture stands for all that lies there.
  const auto tile = [](float place, int count) {
    return static_cast<std::int16_t>(std::floor(std::clamp(place, -1.0f, static_cast<float>(count))));
  };
  for (std::size_t v = 0; v < positions.size() / 3; ++v) {
    const Eigen::Vector4f clip = view * Eigen::Vector4f(positions[3 * v], positions[3 * v + 1], positions[3 * v + 2], 1);
    behind = behind || !(clip.w() > 1e-6f);
    const float scale = 1 / clip.w();
    tile_of_[2 * v] = tile((clip.x() * scale + 1) * across, columns_);
    tile_of_[2 * v + 1] = tile((clip.y() * scale + 1) * up, rows_);
  }
  if (behind) {
    std::ranges::fill(marked_, std::uint8_t{1});
    return;
  }
  for (std::size_t t = 0; t + 2 < triangles.size(); t += 3) {
    const std::int16_t* a = &tile_of_[2 * triangles[t]];
    const std::int16_t* b = &tile_of_[2 * triangles[t + 1]];
    const std::int16_t* c = &tile_of_[2 * triangles[t + 2]];
    const int left = std::max<int>(0, std::min({a[0], b[0], c[0]})), right = std::max({a[0], b[0], c[0]});
    const int low = std::max<int>(0, std::min({a[1], b[1], c[1]})), high = std::max({a[1], b[1], c[1]});
    for (int y = low; y <= std::min(high, rows_ - 1); ++y) {
      for (int x = left; x <= std::min(right, columns_ - 1); ++x) marked_[std::size_t(y) * columns_ + x] = 1;
    }
  }
}

void Tiles::widen(double pixels) {
  const int reach = static_cast<int>(std::ceil(pixels / edge));
  const std::vector<std::uint8_t> before = marked_;
  for (int y = 0; y < rows_; ++y) {
    for (int x = 0; x < columns_; ++x) {
      if (before[std::size_t(y) * columns_ + x] == 0) continue;
      for (int v = std::max(0, y - reach); v <= std::min(rows_ - 1, y + reach); ++v) {
        for (int u = std::max(0, x - reach); u <= std::min(columns_ - 1, x + reach); ++u)
          marked_[std::size_t(v) * columns_ + u] = 1;
      }
    }
  }
}

const std::vector<float>& Tiles::corners() {
  corners_.clear();
  const auto clip = [](int place, int pixels) {
    return std::min(1.0f, 2.0f * static_cast<float>(place * edge) / static_cast<float>(pixels) - 1);
  };
  for (int y = 0; y < rows_; ++y) {
    for (int x = 0; x < columns_; ++x) {
      if (!marked(x, y)) continue;
      int end = x + 1;
      while (end < columns_ && marked(end, y)) ++end;
      const float left = clip(x, width_), right = clip(end, width_), low = clip(y, height_), high = clip(y + 1, height_);
      corners_.insert(corners_.end(), {left, low, right, low, right, high, left, low, right, high, left, high});
      x = end;
    }
  }
  return corners_;
}

}  // namespace supple
