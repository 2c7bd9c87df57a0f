#include "geometry/triangles/welded_surface.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "base/error.h"
#include "geometry/triangles/numbered_surface.h"
#include "geometry/triangles/triangle_edges.h"

namespace supple {
namespace {

// Finds the nearest of the places that were added within a distance, by a grid of cells as wide as the distance.
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
  std::vector<std::string> unwanted_notes;
  const Numbered clean = cleaned(snapped(surface, tolerance), name, &unwanted_notes);
  WeldedSurface result;
  result.mesh = merged(clean.mesh);  // drops the vertices of triangles that were left out
  result.vertex_source.assign(at(result.mesh.points.rows()), -1);
  result.vertex_target.assign(at(surface.points.rows()), -1);
  for (Eigen::Index t = 0; t < result.mesh.triangles.rows(); ++t) {
    const Eigen::Index source = clean.number[at(t)] - 1;
    result.triangle_source.push_back(std::int32_t(source));
    for (int k = 0; k < 3; ++k) {
      const std::int32_t now = result.mesh.triangles(t, k), before = surface.triangles(source, k);
      if (result.vertex_source[at(now)] < 0) result.vertex_source[at(now)] = before;
      result.vertex_target[at(before)] = now;
    }
  }
  return result;
}

std::vector<std::array<std::int32_t, 2>> former_seams(const TriMesh& surface, const WeldedSurface& joined) {
  const std::vector<TriangleEdge> sides = sorted_edges(joined.mesh.triangles);
  const auto ends_before = [&](const TriangleEdge& side) {
    const std::int32_t source = joined.triangle_source[at(side.triangle)];
    const std::int32_t from = surface.triangles(source, side.side), to = surface.triangles(source, (side.side + 1) % 3);
    return side.upward ? std::array{from, to} : std::array{to, from};
  };
  std::vector<std::array<std::int32_t, 2>> seams;
  for (std::size_t i = 1; i < sides.size(); ++i) {
    const TriangleEdge &a = sides[i - 1], &b = sides[i];
    if (a.low != b.low || a.high != b.high || ends_before(a) == ends_before(b)) continue;
    if (seams.empty() || seams.back() != std::array{a.low, a.high}) seams.push_back({a.low, a.high});
  }
  return seams;
}

}  // namespace supple
