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

// Finds the tiles around each vertex. Returns whether all of them lie before the camera. Plain numbers rather than
// matrices let the compiler compute several vertices at once.
bool Tiles::find_tiles(const std::vector<float>& positions, const Eigen::Matrix4f& view, float around) {
  const std::size_t vertices = positions.size() / 3;
  for (std::vector<std::int32_t>* bound : {&left_of_, &right_of_, &low_of_, &high_of_}) bound->resize(vertices);
  const float across = 0.5f * static_cast<float>(width_) / edge, up = 0.5f * static_cast<float>(height_) / edge;
  const auto columns = static_cast<float>(columns_), rows = static_cast<float>(rows_);
  const float x_x = view(0, 0), x_y = view(0, 1), x_z = view(0, 2), x_0 = view(0, 3);
  const float y_x = view(1, 0), y_y = view(1, 1), y_z = view(1, 2), y_0 = view(1, 3);
  const float w_x = view(3, 0), w_y = view(3, 1), w_z = view(3, 2), w_0 = view(3, 3);
  // By how much a way along the ground changes the coordinates at most.
  const float most_x = around * std::hypot(x_x, x_z), most_y = around * std::hypot(y_x, y_z),
              most_w = around * std::hypot(w_x, w_z);
  // One tile beyond each edge of the picture stands for all that lies there.
  const auto tile = [](float place, float count) {
    return static_cast<std::int32_t>(std::floor(std::clamp(place, -1.0f, count)));
  };
  int behind = 0;
  for (std::size_t v = 0; v < vertices; ++v) {
    const float x = positions[3 * v], y = positions[3 * v + 1], z = positions[3 * v + 2];
    const float w = w_x * x + w_y * y + w_z * z + w_0, nearest = w - most_w;
    behind |= nearest > 1e-6f ? 0 : 1;
    const float scale = 1 / w, widened = 1 / nearest;
    const float at_x = (x_x * x + x_y * y + x_z * z + x_0) * scale, at_y = (y_x * x + y_y * y + y_z * z + y_0) * scale;
    const float wide = (most_x + std::abs(at_x) * most_w) * widened,
                high = (most_y + std::abs(at_y) * most_w) * widened;
    left_of_[v] = tile((at_x - wide + 1) * across, columns);
    right_of_[v] = tile((at_x + wide + 1) * across, columns);
    low_of_[v] = tile((at_y - high + 1) * up, rows);
    high_of_[v] = tile((at_y + high + 1) * up, rows);
  }
  return behind == 0;
}

void Tiles::mark(const std::vector<float>& positions, const std::vector<std::uint32_t>& triangles,
                 const Eigen::Matrix4f& view, double around) {
  if (!find_tiles(positions, view, static_cast<float>(around))) {
    std::ranges::fill(marked_, std::uint8_t{1});
    return;
  }
  // Triangles follow their neighbours in a mesh, so that most of them lie in a box that has just been marked.
  int left = columns_, right = -1, low = rows_, high = -1;
  for (std::size_t t = 0; t + 2 < triangles.size(); t += 3) {
    const std::uint32_t a = triangles[t], b = triangles[t + 1], c = triangles[t + 2];
    const int first = std::max(0, std::min({left_of_[a], left_of_[b], left_of_[c]}));
    const int last = std::min(columns_ - 1, std::max({right_of_[a], right_of_[b], right_of_[c]}));
    const int lowest = std::max(0, std::min({low_of_[a], low_of_[b], low_of_[c]}));
    const int highest = std::min(rows_ - 1, std::max({high_of_[a], high_of_[b], high_of_[c]}));
    if (first >= left && last <= right && lowest >= low && highest <= high) continue;
    if (first > last || lowest > highest) continue;
    left = first, right = last, low = lowest, high = highest;
    for (int y = low; y <= high; ++y) {
      for (int x = left; x <= right; ++x) marked_[std::size_t(y) * columns_ + x] = 1;
    }
  }
}

void Tiles::mark(const Tiles& others) {
  for (std::size_t i = 0; i < marked_.size(); ++i) marked_[i] |= others.marked_[i];
}

void Tiles::unmark(const Tiles& others) {
  for (std::size_t i = 0; i < marked_.size(); ++i) {
    if (others.marked_[i] != 0) marked_[i] = 0;
  }
}

void Tiles::narrow() {
  for (std::uint8_t& mark : marked_) mark ^= 1;
  widen();
  for (std::uint8_t& mark : marked_) mark ^= 1;
}

void Tiles::widen() {
  const std::vector<std::uint8_t> before = marked_;
  for (int y = 0; y < rows_; ++y) {
    for (int x = 0; x < columns_; ++x) {
      if (before[std::size_t(y) * columns_ + x] == 0) continue;
      for (int v = std::max(0, y - 1); v <= std::min(rows_ - 1, y + 1); ++v) {
        for (int u = std::max(0, x - 1); u <= std::min(columns_ - 1, x + 1); ++u)
          marked_[std::size_t(v) * columns_ + u] = 1;
      }
    }
  }
}

Tiles::Area Tiles::around() const {
  int left = columns_, right = -1, low = rows_, high = -1;
  for (int y = 0; y < rows_; ++y) {
    for (int x = 0; x < columns_; ++x) {
      if (!marked(x, y)) continue;
      left = std::min(left, x);
      right = std::max(right, x);
      low = std::min(low, y);
      high = y;
    }
  }
  if (right < left) return {0, 0, 0, 0};
  return {left * edge, low * edge, std::min(width_, (right + 1) * edge) - left * edge,
          std::min(height_, (high + 1) * edge) - low * edge};
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
      const float left = clip(x, width_), right = clip(end, width_), low = clip(y, height_),
                  high = clip(y + 1, height_);
      corners_.insert(corners_.end(), {left, low, right, low, right, high, left, low, right, high, left, high});
      x = end;
    }
  }
  return corners_;
}

}  // namespace supple
