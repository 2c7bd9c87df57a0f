#include "geometry/triangles/flat_triangles.h"

#include <algorithm>
#include <array>
#include <tuple>

#include "geometry/triangles/triangle_edges.h"

namespace supple {
namespace {

int longest_side(const TriMesh& mesh, Eigen::Index t) {
  const auto length = [&](int k) { return (corner(mesh, t, (k + 1) % 3) - corner(mesh, t, k)).squaredNorm(); };
  int longest = 0;
  for (const int k : {1, 2})
    if (length(k) > length(longest)) longest = k;
  return longest;
}

class FlatPass {
 public:
  explicit FlatPass(Numbered& surface)
      : surface_(surface),
        sides_(sorted_edges(surface.mesh.triangles)),
        changed_(at(surface.mesh.triangles.rows()), 0),
        gone_(changed_) {}

  // Tells whether anything was mended.
  bool run() {
    const Eigen::Index count = surface_.mesh.triangles.rows();
    bool mended = false;
    for (Eigen::Index t = 0; t < count; ++t) mended |= mend(t);
    if (!mended) return false;
    Triangles triangles(count + std::ssize(added_), 3);
    triangles.topRows(count) = surface_.mesh.triangles;
    for (std::size_t i = 0; i < added_.size(); ++i)
      triangles.row(count + Eigen::Index(i)) << added_[i][0], added_[i][1], added_[i][2];
    surface_.mesh.triangles = std::move(triangles);
    std::vector<Eigen::Index> kept;
    for (Eigen::Index t = 0; t < surface_.mesh.triangles.rows(); ++t)
      if (t >= count || !gone_[at(t)]) kept.push_back(t);
    surface_ = subset(surface_, kept);
    return true;
  }

 private:
  bool mend(Eigen::Index t) {
    const std::array<std::int32_t, 3> corners = corners_of(t);
    const auto [a, b, c] = corners;
    if (changed_[at(t)] || a == b || b == c || c == a || !is_flat(surface_.mesh, t)) return false;
    const int side = longest_side(surface_.mesh, t);
    const std::int32_t from = corners[at(side)], to = corners[at((side + 1) % 3)], middle = corners[at((side + 2) % 3)];
    const auto [low, high] = std::minmax(from, to);
    const auto first = std::ranges::lower_bound(
        sides_, std::pair(low, high), {}, [](const TriangleEdge& edge) { return std::pair(edge.low, edge.high); });
    auto end = first;
    for (; end != sides_.end() && end->low == low && end->high == high; ++end) {
      if (end->triangle != t && (changed_[at(end->triangle)] || std::ranges::count(corners_of(end->triangle), middle)))
        return false;
    }
    if (end - first < 2) return false;
    for (auto other = first; other != end; ++other)
      if (other->triangle != t) cut(other->triangle, other->side, middle);
    changed_[at(t)] = gone_[at(t)] = 1;
    return true;
  }

  void cut(std::int32_t t, int side, std::int32_t middle) {
    std::array<std::int32_t, 3> other = corners_of(t);
    other[at(side)] = middle;
    added_.push_back(other);
    surface_.mesh.triangles(t, (side + 1) % 3) = middle;
    surface_.number.push_back(surface_.number[at(t)]);
    changed_[at(t)] = 1;
  }

  std::array<std::int32_t, 3> corners_of(Eigen::Index t) const {
    const Triangles& triangles = surface_.mesh.triangles;
    return {triangles(t, 0), triangles(t, 1), triangles(t, 2)};
  }

  Numbered& surface_;
  const std::vector<TriangleEdge> sides_;
  std::vector<char> changed_, gone_;  // by triangle
  std::vector<std::array<std::int32_t, 3>> added_;
};

}  // namespace

Numbered with_flat_triangles_mended(Numbered surface) {
  constexpr int passes = 12;
  for (int pass = 0; pass < passes && FlatPass(surface).run();) ++pass;
  return surface;
}

}  // namespace supple
