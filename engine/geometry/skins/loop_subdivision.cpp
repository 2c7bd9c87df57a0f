#include "geometry/skins/loop_subdivision.h"

#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <tuple>
#include <utility>

#include "geometry/skins/flat_slide.h"
#include "geometry/skins/skin_middles.h"

namespace supple {
namespace {

using SparseRows = Eigen::SparseMatrix<double, Eigen::RowMajor>;
using Entries = std::vector<Eigen::Triplet<double>>;

constexpr double corner_cosine = 0.64;  // of 50 degrees: a border that turns by more has a corner there

// Describes one side of an edge: the triangle in which it leads from corner `place` to the next one.
struct EdgeSide {
  std::int32_t low, high;  // nodes at its ends
  std::int32_t triangle;
  int place;
};

struct SurfaceEdge {
  std::int32_t low, high;   // nodes at its ends
  std::int32_t begin, end;  // its sides
  bool sharp;
};

// Holds a surface as nodes and edges. Skin vertices at one place are one node; first nodes are the mesh's vertices.
struct EdgedSurface {
  std::vector<std::int32_t> node_of;  // by skin vertex
  Eigen::Index nodes = 0;
  std::vector<EdgeSide> sides;               // those of an edge stand together
  std::vector<SurfaceEdge> edges;            // in the order of their nodes
  std::vector<std::int32_t> begin, edge_at;  // by node, and one more: the edges that end there
};

// Returns the number of a skin vertex's normal. Vertices that have one normal have one number.
std::int32_t normal_of(const Skin& skin, std::int32_t vertex) {
  return skin.smooth.empty() ? vertex : skin.smooth[std::size_t(vertex)];
}

bool is_sharp(const Skin& skin, const std::vector<EdgeSide>& sides, std::int32_t begin, std::int32_t end,
              const std::vector<std::int32_t>& node_of) {
  if (end - begin != 2) return true;
  const auto normals = [&](const EdgeSide& side) {
    const std::int32_t from = skin.rest.triangles(side.triangle, side.place),
                       to = skin.rest.triangles(side.triangle, (side.place + 1) % 3);
    return node_of[std::size_t(from)] == side.low ? std::pair(normal_of(skin, from), normal_of(skin, to))
                                                  : std::pair(normal_of(skin, to), normal_of(skin, from));
  };
  return normals(sides[std::size_t(begin)]) != normals(sides[std::size_t(begin) + 1]);
}

EdgedSurface with_edges(const Skin& skin, std::vector<std::int32_t> node_of, Eigen::Index nodes) {
  EdgedSurface surface;
  surface.node_of = std::move(node_of);
  surface.nodes = nodes;
  for (std::int32_t t = 0; t < skin.rest.triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax({surface.node_of[std::size_t(skin.rest.triangles(t, k))],
                                            surface.node_of[std::size_t(skin.rest.triangles(t, (k + 1) % 3))]});
      surface.sides.push_back({low, high, t, k});
    }
  }
  std::ranges::sort(surface.sides, {},
                    [](const EdgeSide& side) { return std::tuple(side.low, side.high, side.triangle, side.place); });
  surface.begin.assign(std::size_t(nodes) + 1, 0);
  const auto count = static_cast<std::int32_t>(surface.sides.size());
  for (std::int32_t s = 0; s < count;) {
    const EdgeSide& first = surface.sides[std::size_t(s)];
    std::int32_t end = s + 1;
    while (end < count && surface.sides[std::size_t(end)].low == first.low &&
           surface.sides[std::size_t(end)].high == first.high)
      ++end;
    surface.edges.push_back({first.low, first.high, s, end, is_sharp(skin, surface.sides, s, end, surface.node_of)});
    ++surface.begin[std::size_t(first.low) + 1];
    ++surface.begin[std::size_t(first.high) + 1];
    s = end;
  }
  for (std::size_t n = 0; n < std::size_t(nodes); ++n) surface.begin[n + 1] += surface.begin[n];
  surface.edge_at.resize(2 * surface.edges.size());
  std::vector<std::int32_t> next(surface.begin.begin(), surface.begin.end() - 1);
  for (std::size_t e = 0; e < surface.edges.size(); ++e) {
    for (const std::int32_t node : {surface.edges[e].low, surface.edges[e].high})
      surface.edge_at[std::size_t(next[std::size_t(node)]++)] = static_cast<std::int32_t>(e);
  }
  return surface;
}

// Tells by which neighbours a node moves: those around it, the two along a crease, or none.
enum class NodeKind { smooth, crease, corner };
struct NodeRing {
  NodeKind kind;
  std::vector<std::int32_t> neighbours;
};

NodeRing ring_of(const EdgedSurface& surface, std::size_t node) {
  std::vector<std::int32_t> all, sharp;
  for (std::int32_t i = surface.begin[node]; i < surface.begin[node + 1]; ++i) {
    const SurfaceEdge& edge = surface.edges[std::size_t(surface.edge_at[std::size_t(i)])];
    const std::int32_t other = edge.low == std::int32_t(node) ? edge.high : edge.low;
    all.push_back(other);
    if (edge.sharp) sharp.push_back(other);
  }
  if (all.empty() || sharp.size() > 2) return {NodeKind::corner, {}};
  if (sharp.size() == 2) return {NodeKind::crease, std::move(sharp)};
  return {NodeKind::smooth, std::move(all)};
}

// Returns the rings of all nodes. corners: the corners of the first level, by node; empty: this is the first level,
// where a crease that turns has a corner.
std::vector<NodeRing> rings_of(const EdgedSurface& surface, const Positions& places, const std::vector<char>& corners) {
  std::vector<NodeRing> rings;
  for (std::size_t n = 0; n < std::size_t(surface.nodes); ++n) {
    NodeRing ring = ring_of(surface, n);
    bool turns = n < corners.size() && corners[n] != 0;
    if (ring.kind == NodeKind::crease && corners.empty()) {
      const Vec3 here = places.row(Eigen::Index(n)), from = places.row(ring.neighbours[0]),
                 to = places.row(ring.neighbours[1]);
      turns = (here - from).dot(to - here) < corner_cosine * (here - from).norm() * (to - here).norm();
    }
    if (turns) ring = {NodeKind::corner, {}};
    rings.push_back(std::move(ring));
  }
  return rings;
}

// Returns the weight of each of n neighbours of a smooth vertex (Loop 1987, "Smooth subdivision surfaces based on
// triangles").
double loop_weight(std::size_t n) {
  const double wave = 3.0 / 8 + std::cos(2 * std::numbers::pi / double(n)) / 4;
  return (5.0 / 8 - wave * wave) / double(n);
}

// Appends a row with one weight for each neighbour of a node, and for the node what is left to 1.
void append_ring(Entries& entries, std::int32_t node, const NodeRing& ring, double weight) {
  for (const std::int32_t other : ring.neighbours) entries.emplace_back(node, other, weight);
  entries.emplace_back(node, node, 1 - weight * double(ring.neighbours.size()));
}

SparseRows matrix_of(const Entries& entries, Eigen::Index rows, Eigen::Index columns) {
  SparseRows matrix(rows, columns);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

// Returns the matrix that moves control points outwards by as much as the limit surface lies inside of them. Limits are
// those of Hoppe et al. (1994, "Piecewise smooth surface reconstruction").
SparseRows quasi_interpolation(const std::vector<NodeRing>& rings) {
  Entries entries;
  for (std::size_t n = 0; n < rings.size(); ++n) {
    const std::size_t around = rings[n].neighbours.size();
    const double inwards = rings[n].kind == NodeKind::smooth   ? 1 / (3 / (8 * loop_weight(around)) + double(around))
                           : rings[n].kind == NodeKind::crease ? 1.0 / 6
                                                               : 0.0;
    append_ring(entries, static_cast<std::int32_t>(n), rings[n], -inwards);
  }
  return matrix_of(entries, Eigen::Index(rings.size()), Eigen::Index(rings.size()));
}

// Returns the matrix of one level: the old nodes, then one for each edge.
SparseRows one_level(const Skin& skin, const EdgedSurface& surface, const std::vector<NodeRing>& rings) {
  Entries entries;
  for (std::size_t n = 0; n < rings.size(); ++n) {
    const double weight = rings[n].kind == NodeKind::smooth ? loop_weight(rings[n].neighbours.size()) : 1.0 / 8;
    append_ring(entries, static_cast<std::int32_t>(n), rings[n], weight);
  }
  auto row = static_cast<std::int32_t>(surface.nodes);
  for (const SurfaceEdge& edge : surface.edges) {
    for (const std::int32_t end : {edge.low, edge.high}) entries.emplace_back(row, end, edge.sharp ? 1.0 / 2 : 3.0 / 8);
    for (std::int32_t s = edge.begin; s < edge.end && !edge.sharp; ++s) {
      const EdgeSide& side = surface.sides[std::size_t(s)];
      const std::int32_t opposite = skin.rest.triangles(side.triangle, (side.place + 2) % 3);
      entries.emplace_back(row, surface.node_of[std::size_t(opposite)], 1.0 / 8);
    }
    ++row;
  }
  return matrix_of(entries, row, surface.nodes);
}

// Cuts each triangle into four, and appends the skin vertices in the middles of edges: one for each edge, or one for
// each of its sides where the skin is split along it.
void cut_triangles(Skin& skin, EdgedSurface& surface) {
  std::vector<std::array<std::int32_t, 3>> middles(std::size_t(skin.rest.triangles.rows()));
  SkinMiddles added(skin);
  for (std::size_t e = 0; e < surface.edges.size(); ++e) {
    std::vector<std::array<std::int32_t, 3>> made;  // two skin vertices, and the one between
    for (std::int32_t s = surface.edges[e].begin; s < surface.edges[e].end; ++s) {
      const EdgeSide& side = surface.sides[std::size_t(s)];
      const std::int32_t from = skin.rest.triangles(side.triangle, side.place);
      const std::int32_t to = skin.rest.triangles(side.triangle, (side.place + 1) % 3);
      const std::int32_t a = std::min(from, to), b = std::max(from, to);
      auto known = std::ranges::find_if(made, [&](const auto& one) { return one[0] == a && one[1] == b; });
      if (known == made.end()) {
        made.push_back({a, b, static_cast<std::int32_t>(surface.node_of.size())});
        surface.node_of.push_back(static_cast<std::int32_t>(surface.nodes + Eigen::Index(e)));
        added.append(std::size_t(a), std::size_t(b));
        known = made.end() - 1;
      }
      middles[std::size_t(side.triangle)][std::size_t(side.place)] = (*known)[2];
    }
  }
  const Triangles before = skin.rest.triangles;
  skin.rest.triangles.resize(4 * before.rows(), 3);
  for (Eigen::Index t = 0; t < before.rows(); ++t) {
    const auto& [ab, bc, ca] = middles[std::size_t(t)];
    skin.rest.triangles.row(4 * t) << before(t, 0), ab, ca;
    skin.rest.triangles.row(4 * t + 1) << before(t, 1), bc, ab;
    skin.rest.triangles.row(4 * t + 2) << before(t, 2), ca, bc;
    skin.rest.triangles.row(4 * t + 3) << ab, bc, ca;
  }
}

// Returns the rows of skin vertices, which are those of their nodes.
SurfaceWeights by_skin_vertex(const SparseRows& by_node, const std::vector<std::int32_t>& node_of) {
  SurfaceWeights weights;
  weights.begin.push_back(0);
  for (const std::int32_t node : node_of) {
    for (SparseRows::InnerIterator entry(by_node, node); entry; ++entry) {
      if (entry.value() == 0) continue;
      weights.vertex.push_back(static_cast<std::int32_t>(entry.col()));
      weights.weight.push_back(entry.value());
    }
    weights.begin.push_back(static_cast<std::int32_t>(weights.vertex.size()));
  }
  return weights;
}

}  // namespace

SurfaceWeights subdivide(Skin& skin, const std::vector<std::int32_t>& vertex_of, const Positions& mesh, int levels) {
  SparseRows weights(mesh.rows(), mesh.rows());
  weights.setIdentity();
  std::vector<std::int32_t> node_of = vertex_of;
  std::vector<char> corners;
  for (int level = 0; level < levels; ++level) {
    EdgedSurface surface = with_edges(skin, std::move(node_of), weights.rows());
    const std::vector<NodeRing> rings = rings_of(surface, mesh, corners);
    if (level == 0) {
      for (const NodeRing& ring : rings) corners.push_back(ring.kind == NodeKind::corner ? 1 : 0);
      weights = quasi_interpolation(rings);
    }
    weights = SparseRows(one_level(skin, surface, rings) * weights);
    cut_triangles(skin, surface);
    node_of = std::move(surface.node_of);
  }
  SurfaceWeights result = by_skin_vertex(weights, node_of);
  skin.rest.points.resize(result.rows(), 3);
  for (Eigen::Index v = 0; v < result.rows(); ++v) skin.rest.points.row(v) = weighted_point(result, v, mesh);
  slide_on_flat(result, vertex_of, mesh.rows(), skin);
  return result;
}

}  // namespace supple
