#include "geometry/triangles/welded_surface.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_map>

#include "base/error.h"
#include "geometry/triangles/flat_triangles.h"
#include "geometry/triangles/numbered_surface.h"
#include "geometry/triangles/triangle_edges.h"

namespace supple {
namespace {

// Finds the nearest place within a distance, among those that were added, by a grid of cells as wide as the distance.
class PlaceGrid {
 public:
  explicit PlaceGrid(double reach) : reach_(reach) {}

  // Returns the number of the nearest place, the first added of equally near ones; -1: none is within reach.
  std::int32_t nearest(const Vec3& p, const Positions& places) const {
    std::int32_t best = -1;
    double squared = reach_ * reach_;
    const Cell middle = cell_of(p);
    for (int i = 0; i < 27; ++i) {
      const auto found = cells_.find({middle[0] + i % 3 - 1, middle[1] + i / 3 % 3 - 1, middle[2] + i / 9 - 1});
      if (found == cells_.end()) continue;
      for (const std::int32_t v : found->second) {
        const double own = (places.row(v).transpose() - p).squaredNorm();
        if (own < squared || (own == squared && (best < 0 || v < best))) {
          best = v;
          squared = own;
        }
      }
    }
    return best;
  }

  void add(std::int32_t number, const Vec3& p) { cells_[cell_of(p)].push_back(number); }

 private:
  using Cell = std::array<std::int64_t, 3>;
  struct CellHash {
    std::size_t operator()(const Cell& cell) const {  // the primes of Teschner et al. 2003 keep neighbours apart
      return std::size_t(cell[0]) * 73856093 ^ std::size_t(cell[1]) * 19349663 ^ std::size_t(cell[2]) * 83492791;
    }
  };

  Cell cell_of(const Vec3& p) const {
    Cell cell;
    for (int k = 0; k < 3; ++k) cell[std::size_t(k)] = std::int64_t(std::floor(p[k] / reach_));
    return cell;
  }

  double reach_;
  std::unordered_map<Cell, std::vector<std::int32_t>, CellHash> cells_;
};

// Moves each vertex to the nearest earlier one that stays where it is. A tolerance beyond the precision of doubles does
// nothing, because the cells could not be counted.
TriMesh snapped(TriMesh surface, double tolerance) {
  double furthest = 0;  // from the origin, along an axis
  for (const std::int32_t v : surface.triangles.reshaped())
    furthest = std::max(furthest, surface.points.row(v).cwiseAbs().maxCoeff());
  if (!(tolerance > 1e-15 * furthest)) return surface;
  PlaceGrid grid(tolerance);
  for (Eigen::Index v = 0; v < surface.points.rows(); ++v) {
    const Vec3 p = surface.points.row(v);
    if (!p.allFinite() || p.cwiseAbs().maxCoeff() > furthest) continue;  // no triangle names it
    const std::int32_t near = grid.nearest(p, surface.points);
    if (near < 0) {
      grid.add(std::int32_t(v), p);
    } else {
      surface.points.row(v) = surface.points.row(near).eval();
    }
  }
  return surface;
}

}  // namespace

WeldedSurface welded(const TriMesh& surface, double tolerance, const std::string& name) {
  if (!(tolerance >= 0 && tolerance < infinity))
    throw InputError(name, fmt::format("cannot be welded within {} m; 0 or more is allowed", tolerance));
  check_numbers(surface, name);
  const TriMesh raw = merged(snapped(surface, tolerance));  // with all triangles
  std::vector<Eigen::Index> numbers(at(raw.triangles.rows()));
  std::iota(numbers.begin(), numbers.end(), 0);
  const Numbered mended = with_flat_triangles_mended({raw, numbers});
  std::vector<std::string> unwanted_notes;
  const Numbered clean = cleaned(mended.mesh, name, &unwanted_notes);
  WeldedSurface result;
  result.mesh = merged(clean.mesh);  // drops the vertices of triangles that were left out
  std::vector<std::int32_t> target(at(raw.points.rows()), -1);
  for (Eigen::Index t = 0; t < result.mesh.triangles.rows(); ++t) {
    const Eigen::Index part = clean.number[at(t)] - 1, source = mended.number[at(part)];
    result.triangle_source.push_back(std::int32_t(source));
    std::array<std::int32_t, 3>& corners = result.corner_source.emplace_back();
    for (int k = 0; k < 3; ++k) {
      const std::int32_t before = mended.mesh.triangles(part, k);
      target[at(before)] = result.mesh.triangles(t, k);
      corners[at(k)] = before == raw.triangles(source, k) ? surface.triangles(source, k) : -1;
    }
  }
  result.vertex_source.assign(at(result.mesh.points.rows()), -1);
  result.vertex_target.assign(at(surface.points.rows()), -1);
  for (Eigen::Index i = 0; i < raw.triangles.size(); ++i) {
    const std::int32_t before = surface.triangles.data()[i], now = target[at(raw.triangles.data()[i])];
    result.vertex_target[at(before)] = now;
    if (now >= 0 && result.vertex_source[at(now)] < 0) result.vertex_source[at(now)] = before;
  }
  return result;
}

std::vector<std::array<std::int32_t, 2>> former_seams(const WeldedSurface& joined) {
  const std::vector<TriangleEdge> sides = sorted_edges(joined.mesh.triangles);
  const auto differ = [&](const TriangleEdge& a, const TriangleEdge& b, bool upper) {
    const auto before = [&](const TriangleEdge& side) {
      return joined.corner_source[at(side.triangle)][at(side.upward == upper ? (side.side + 1) % 3 : side.side)];
    };
    return before(a) >= 0 && before(b) >= 0 && before(a) != before(b);
  };
  std::vector<std::array<std::int32_t, 2>> seams;
  for (std::size_t i = 1; i < sides.size(); ++i) {
    const TriangleEdge &a = sides[i - 1], &b = sides[i];
    if (a.low != b.low || a.high != b.high || !(differ(a, b, false) || differ(a, b, true))) continue;
    if (seams.empty() || seams.back() != std::array{a.low, a.high}) seams.push_back({a.low, a.high});
  }
  return seams;
}

}  // namespace supple
