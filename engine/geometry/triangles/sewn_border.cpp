#include "geometry/triangles/sewn_border.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "base/disjoint_sets.h"
#include "geometry/triangles/triangle_edges.h"

namespace supple {
namespace {

using Cell = std::array<std::int64_t, 3>;

// Holds the border of a surface, each of whose vertices may stand for several that were joined.
struct Border {
  std::vector<std::int32_t> vertices;                   // in increasing order
  std::vector<std::array<std::int32_t, 2>> edges;       // those that have one triangle
  std::map<std::int32_t, std::set<std::int32_t>> near;  // by border vertex: those to which an edge leads
};

Border border_of(const Triangles& triangles) {
  Border border;
  const std::vector<TriangleEdge> edges = sorted_edges(triangles);
  const auto same = [&](std::size_t a, std::size_t b) {
    return edges[a].low == edges[b].low && edges[a].high == edges[b].high;
  };
  std::set<std::int32_t> vertices;
  for (std::size_t e = 0; e < edges.size(); ++e) {
    if ((e > 0 && same(e, e - 1)) || (e + 1 < edges.size() && same(e, e + 1))) continue;
    border.edges.push_back({edges[e].low, edges[e].high});
    vertices.insert({edges[e].low, edges[e].high});
  }
  for (const TriangleEdge& edge : edges) {
    if (vertices.contains(edge.low)) border.near[edge.low].insert(edge.high);
    if (vertices.contains(edge.high)) border.near[edge.high].insert(edge.low);
  }
  border.vertices.assign(vertices.begin(), vertices.end());
  return border;
}

// Finds border vertices by their places.
class BorderGrid {
 public:
  BorderGrid(const Border& border, const Positions& points, double reach)
      : border_(border), points_(points), reach_(reach) {
    for (const std::int32_t v : border.vertices) cells_[cell_of(v)].push_back(v);
  }

  // Returns the nearest vertex within reach that no edge joins to this one, the first of equally near ones; -1: none.
  std::int32_t nearest(std::int32_t vertex) const {
    std::int32_t best = -1;
    double squared = reach_ * reach_;
    const Cell middle = cell_of(vertex);
    const std::set<std::int32_t>& near = border_.near.at(vertex);
    for (int i = 0; i < 27; ++i) {
      const auto cell = cells_.find({middle[0] + i % 3 - 1, middle[1] + i / 3 % 3 - 1, middle[2] + i / 9 - 1});
      if (cell == cells_.end()) continue;
      for (const std::int32_t other : cell->second) {
        const double own = (points_.row(other) - points_.row(vertex)).squaredNorm();
        const bool nearer = own < squared || (own == squared && (best < 0 || other < best));
        if (other == vertex || !nearer || near.contains(other)) continue;
        best = other;
        squared = own;
      }
    }
    return best;
  }

 private:
  Cell cell_of(std::int32_t vertex) const {
    Cell cell;
    for (int k = 0; k < 3; ++k) cell[std::size_t(k)] = std::int64_t(std::floor(points_(vertex, k) / reach_));
    return cell;
  }

  const Border& border_;
  const Positions& points_;
  const double reach_;
  std::map<Cell, std::vector<std::int32_t>> cells_;
};

// Returns the mesh of the vertices that are left, numbered in the order that they had.
TriMesh with_vertices_left(const Positions& points, Triangles triangles, DisjointSets& sets) {
  std::vector<std::int32_t> number(std::size_t(points.rows()), -1);
  std::vector<Eigen::Index> kept;
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (sets.of(v) != v) continue;
    number[v] = static_cast<std::int32_t>(kept.size());
    kept.push_back(Eigen::Index(v));
  }
  for (std::int32_t& v : triangles.reshaped()) v = number[std::size_t(v)];
  return {points(kept, Eigen::all), std::move(triangles)};
}

double distance_to(const Vec3& p, const Vec3& from, const Vec3& to) {
  const Vec3 way = to - from;
  const double along = std::clamp((p - from).dot(way) / std::max(way.squaredNorm(), 1e-300), 0.0, 1.0);
  return (p - from - along * way).norm();
}

// Counts the border vertices that lie within a distance of a border edge that is not theirs.
long count_beside(const Border& border, const Positions& points, double distance) {
  return std::ranges::count_if(border.vertices, [&](std::int32_t v) {
    const std::set<std::int32_t>& near = border.near.at(v);
    return std::ranges::any_of(border.edges, [&](const auto& edge) {
      if (distance_to(points.row(v), points.row(edge[0]), points.row(edge[1])) > distance) return false;
      // An edge with one end beside the vertex continues the vertex's own border. With both ends beside it, the edge
      // and the vertex bound a slit.
      return edge[0] != v && edge[1] != v && near.contains(edge[0]) == near.contains(edge[1]);
    });
  });
}

}  // namespace

SewnSurface sewn_border(const TriMesh& surface, double distance) {
  SewnSurface result;
  DisjointSets sets(std::size_t(surface.points.rows()));
  Positions points = surface.points;
  Triangles triangles = surface.triangles;
  std::vector<double> members(sets.size(), 1);
  for (bool joins = true; joins;) {
    joins = false;
    const Border border = border_of(triangles);
    const BorderGrid grid(border, points, distance);
    std::map<std::int32_t, std::int32_t> nearest;
    for (const std::int32_t v : border.vertices) nearest[v] = grid.nearest(v);
    for (const auto& [v, other] : nearest) {
      if (other <= v || nearest.at(other) != v) continue;
      const auto a = std::size_t(v), b = std::size_t(other);
      result.furthest = std::max(result.furthest, (points.row(v) - points.row(other)).norm());
      points.row(v) = (members[a] * points.row(v) + members[b] * points.row(other)) / (members[a] + members[b]);
      members[a] += members[b];
      sets.join(a, b);
      ++result.joined;
      joins = true;
    }
    for (std::int32_t& v : triangles.reshaped()) v = static_cast<std::int32_t>(sets.of(std::size_t(v)));
  }
  result.mesh = with_vertices_left(points, std::move(triangles), sets);
  const Border border = border_of(result.mesh.triangles);
  result.left = long(border.vertices.size());
  result.beside = result.joined > 0 ? count_beside(border, result.mesh.points, distance) : 0;
  return result;
}

}  // namespace supple
