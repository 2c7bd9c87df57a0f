#include "geometry/triangles/triangle_edges.h"

#include <algorithm>
#include <tuple>

namespace supple {

// Few edges start at a vertex, so that it is quicker to put them into the places of their lower vertices, and then to
// sort those of each vertex, than to sort them all.
std::vector<TriangleEdge> sorted_edges(const Triangles& triangles) {
  const auto index = [](std::int32_t v) { return static_cast<std::size_t>(v); };
  std::vector<std::size_t> start(triangles.size() == 0 ? 1 : index(triangles.maxCoeff()) + 2, 0);
  const auto visit = [&](const auto& edge) {
    for (std::int32_t t = 0; t < triangles.rows(); ++t) {
      for (int k = 0; k < 3; ++k) {
        const std::int32_t from = triangles(t, k), to = triangles(t, (k + 1) % 3);
        edge(TriangleEdge{std::min(from, to), std::max(from, to), t, std::int8_t(k), from < to});
      }
    }
  };
  visit([&](const TriangleEdge& edge) { ++start[index(edge.low) + 1]; });
  for (std::size_t v = 1; v < start.size(); ++v) start[v] += start[v - 1];
  std::vector<TriangleEdge> edges(static_cast<std::size_t>(triangles.size()));
  std::vector<std::size_t> next(start.begin(), start.end() - 1);
  visit([&](const TriangleEdge& edge) { edges[next[index(edge.low)]++] = edge; });
  for (std::size_t v = 0; v + 1 < start.size(); ++v) {
    std::sort(edges.begin() + std::ptrdiff_t(start[v]), edges.begin() + std::ptrdiff_t(start[v + 1]),
              [](const TriangleEdge& a, const TriangleEdge& b) {
                return std::tie(a.high, a.triangle, a.side) < std::tie(b.high, b.triangle, b.side);
              });
  }
  return edges;
}

EdgesByTriangle edges_by_triangle(const Triangles& triangles) {
  EdgesByTriangle all;
  all.begin.assign(std::size_t(triangles.rows()) + 1, 0);
  std::vector<TriangleEdge> own;  // the first of those between the same vertices
  for (const TriangleEdge& edge : sorted_edges(triangles)) {
    if (own.empty() || own.back().low != edge.low || own.back().high != edge.high) own.push_back(edge);
  }
  std::ranges::sort(own, {}, [](const TriangleEdge& edge) { return std::pair(edge.triangle, edge.side); });
  for (const TriangleEdge& edge : own) {
    all.edges.push_back({edge.low, edge.high});
    ++all.begin[std::size_t(edge.triangle) + 1];
  }
  for (std::size_t t = 1; t < all.begin.size(); ++t) all.begin[t] += all.begin[t - 1];
  return all;
}

}  // namespace supple
