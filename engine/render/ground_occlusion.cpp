#include "render/ground_occlusion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace supple {
namespace {

// Returns the triangles that stand for a mesh: of cloth those that cast its shadow, which are a quarter of all.
const std::vector<std::uint32_t>& triangles_over_ground(const DrawMesh& mesh) {
  return mesh.cloth && !mesh.shadow_triangles.empty() ? mesh.shadow_triangles : mesh.triangles;
}

}  // namespace

GroundOcclusion::GroundOcclusion(double largest_body)
    : reach_(0.6 * largest_body), covers_(cells * cells), open_(cells * cells) {}

// Records a piece of surface that lies over an area of the ground [m^2]. It is shared between the four cells around its
// place, so that shade does not change from cell to cell as a body moves (the cloud-in-cell scheme of Birdsall and Fuss
// 1969).
void GroundOcclusion::cover(float x, float y, float z, float area) {
  const float u = x * by_cell_ - first_u_, v = z * by_cell_ - first_v_;
  if (!(u >= 0 && v >= 0 && u < cells - 1 && v < cells - 1)) return;
  const int i = static_cast<int>(u), j = static_cast<int>(v);
  const float s = u - static_cast<float>(i), t = v - static_cast<float>(j);
  const float shares[4] = {(1 - s) * (1 - t), s * (1 - t), (1 - s) * t, s * t};
  for (int k = 0; k < 4; ++k) {
    Cover& cell = covers_[std::size_t(j + k / 2) * cells + std::size_t(i + k % 2)];
    cell.area += shares[k] * area;
    cell.height += shares[k] * area * y;
  }
}

// Records a triangle in pieces of less than a cell. Of closed bodies only the triangles that look down count.
void GroundOcclusion::cover_by_triangle(const float* a, const float* b, const float* c, bool two_sided) {
  const auto high = static_cast<float>(reach_);
  if (a[1] > high && b[1] > high && c[1] > high) return;
  float area = 0.5f * ((b[0] - a[0]) * (c[2] - a[2]) - (b[2] - a[2]) * (c[0] - a[0]));
  if (two_sided) area = std::abs(area);
  if (!(area > 0)) return;
  const auto span = [](float p, float q, float r) { return std::max({p, q, r}) - std::min({p, q, r}); };
  const float widest = std::max(span(a[0], b[0], c[0]), span(a[2], b[2], c[2])) * by_cell_ / 0.7f;  // in pieces
  const int parts = std::clamp(static_cast<int>(std::ceil(std::min(widest, 1e6f))), 1, 2 * cells);
  const auto whole = static_cast<float>(parts), each = area / (whole * whole);
  const auto cover_at = [&](float s, float t) {
    const auto at = [&](int k) { return a[k] + s * (b[k] - a[k]) + t * (c[k] - a[k]); };
    if (at(1) <= high) cover(at(0), std::max(at(1), 0.0f), at(2), each);
  };
  for (int i = 0; i < parts; ++i) {
    for (int k = 0; k + i < parts; ++k) {
      const auto s = static_cast<float>(i), t = static_cast<float>(k);
      cover_at((s + 1.0f / 3) / whole, (t + 1.0f / 3) / whole);
      if (i + k + 1 < parts) cover_at((s + 2.0f / 3) / whole, (t + 2.0f / 3) / whole);
    }
  }
}

const std::vector<float>& GroundOcclusion::compute(const std::vector<DrawMesh>& meshes,
                                                   const std::vector<std::vector<float>>& positions, const Vec3& center,
                                                   double extent) {
  extent_ = extent;
  origin_x_ = center.x() - 0.5 * extent_;
  origin_z_ = center.z() - 0.5 * extent_;
  const double cell = extent_ / cells;
  by_cell_ = static_cast<float>(1 / cell);
  first_u_ = static_cast<float>(origin_x_ / cell + 0.5);
  first_v_ = static_cast<float>(origin_z_ / cell + 0.5);
  std::fill(covers_.begin(), covers_.end(), Cover{});
  for (std::size_t m = 0; m < positions.size(); ++m) {
    if (meshes[m].ghost) continue;
    const std::vector<float>& points = positions[m];
    const std::vector<std::uint32_t>& triangles = triangles_over_ground(meshes[m]);
    for (std::size_t t = 0; t + 2 < triangles.size(); t += 3)
      cover_by_triangle(&points[3 * triangles[t]], &points[3 * triangles[t + 1]], &points[3 * triangles[t + 2]],
                        meshes[m].two_sided);
  }
  // A patch at height y, seen from a point at distance d beside it, covers this share of the sky: y^2 dA / (pi (d^2 +
  // y^2)^2). At the least height, a cell that is covered whole hides the whole sky from the ground below. All shares
  // are taken larger than they are: a studio's sky is darker near the horizon, and a body should be seen to stand.
  constexpr float stronger = 1.3f;
  std::fill(open_.begin(), open_.end(), 1.0f);
  const int radius = std::max(1, static_cast<int>(reach_ / cell));
  const auto whole = static_cast<float>(cell * cell), lowest = static_cast<float>(cell / std::sqrt(std::numbers::pi));
  const Eigen::ArrayXf squares =  // of distances along one axis, from -radius to radius cells [m^2]
      (Eigen::ArrayXf::LinSpaced(2 * radius + 1, static_cast<float>(-radius), static_cast<float>(radius)) *
       static_cast<float>(cell))
          .square();
  for (int j = 0; j < cells; ++j) {
    for (int i = 0; i < cells; ++i) {
      const Cover& cover = covers_[std::size_t(j) * cells + i];
      if (cover.area <= 1e-3f * whole) continue;
      const float y = std::max(cover.height / cover.area, lowest);
      const float patch = stronger * std::min(cover.area, whole) / static_cast<float>(std::numbers::pi);
      const int left = std::max(0, i - radius), count = std::min(cells - 1, i + radius) - left + 1;
      const auto across = squares.segment(left - i + radius, count);
      for (int v = std::max(0, j - radius); v <= std::min(cells - 1, j + radius); ++v) {
        Eigen::Map<Eigen::ArrayXf> row(&open_[std::size_t(v) * cells + left], count);
        row -= (y * y * patch) / (across + (squares[v - j + radius] + y * y)).square();
      }
    }
  }
  for (float& value : open_) value = std::max(value, 0.0f);
  return open_;
}

// A uniform cubic B-spline over the cells has these weights at a cell's middle and half-way to the next one.
void GroundOcclusion::smooth() {
  const auto weigh = [](float a, float b, float c, float d, bool half_way) {
    return half_way ? (a + 23 * (b + c) + d) * (1.0f / 48) : (a + 4 * b + c) * (1.0f / 6);
  };
  const auto nearest = [](int cell) { return std::size_t(std::clamp(cell, 0, cells - 1)); };
  // The square's border, over its edge from the middle, where contact shade fades.
  constexpr float fades = 0.42f, gone = 0.495f;
  const auto shown = [&](int node) {
    const float off = std::abs((0.5f * static_cast<float>(node) + 0.5f) / cells - 0.5f);
    const float t = std::clamp((gone - off) / (gone - fades), 0.0f, 1.0f);
    return t * t * (3 - 2 * t);
  };
  between_.resize(std::size_t(nodes) * cells);
  smooth_.resize(std::size_t(nodes) * nodes);
  for (int v = 0; v < nodes; ++v) {
    const float* rows[4];
    for (int k = 0; k < 4; ++k) rows[k] = &open_[nearest(v / 2 - 1 + k) * cells];
    float* to = &between_[std::size_t(v) * cells];
    for (int u = 0; u < cells; ++u) to[u] = weigh(rows[0][u], rows[1][u], rows[2][u], rows[3][u], v % 2 == 1);
  }
  std::array<float, nodes> share;
  for (int u = 0; u < nodes; ++u) share[std::size_t(u)] = shown(u);
  for (int v = 0; v < nodes; ++v) {
    const float* from = &between_[std::size_t(v) * cells];
    float* to = &smooth_[std::size_t(v) * nodes];
    for (int u = 0; u < nodes; ++u) {
      const int cell = u / 2;
      const float value =
          weigh(from[nearest(cell - 1)], from[cell], from[nearest(cell + 1)], from[nearest(cell + 2)], u % 2 == 1);
      to[u] = 1 + share[std::size_t(u)] * share[std::size_t(v)] * (value - 1);
    }
  }
}

}  // namespace supple
