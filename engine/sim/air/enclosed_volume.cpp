#include "sim/air/enclosed_volume.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace supple {

double signed_volume(const Triangles& triangles, Eigen::Index first, Eigen::Index count, const Positions& x) {
  if (count == 0) return 0;
  const Vec3 origin = x.row(triangles(first, 0));
  double sum = 0;
  for (Eigen::Index t = first; t < first + count; ++t) {
    const Vec3 a = x.row(triangles(t, 0)).transpose() - origin, b = x.row(triangles(t, 1)).transpose() - origin,
               c = x.row(triangles(t, 2)).transpose() - origin;
    sum += a.dot(b.cross(c));
  }
  return sum / 6;
}

std::string why_not_closed(const Triangles& triangles, const Positions& x) {
  struct Edge {
    std::array<std::int32_t, 2> ends;  // the lower number first
    int way;                           // 1: passed from the lower to the higher number; -1: the other way
  };
  std::vector<Edge> edges;
  edges.reserve(3 * std::size_t(triangles.rows()));
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const std::int32_t from = triangles(t, k), to = triangles(t, (k + 1) % 3);
      edges.push_back({{std::min(from, to), std::max(from, to)}, from < to ? 1 : -1});
    }
  }
  std::ranges::sort(edges, {}, &Edge::ends);
  int open = 0, turned = 0;
  for (std::size_t i = 0; i < edges.size();) {
    int count = 0, sum = 0;
    for (const std::array<std::int32_t, 2> ends = edges[i].ends; i < edges.size() && edges[i].ends == ends; ++i) {
      ++count;
      sum += edges[i].way;
    }
    open += count % 2;
    turned += count % 2 == 0 && sum != 0;
  }
  if (triangles.rows() == 0) return "has no triangles";
  if (open > 0) return fmt::format("is not closed: {} of its edges belong to an odd number of triangles", open);
  if (turned > 0)
    return fmt::format("has triangles that are turned against their neighbours, at {} edges: it has no inside", turned);
  const Vec3 extent = bounds_of(x).extent();
  if (std::abs(signed_volume(triangles, 0, triangles.rows(), x)) <= 1e-9 * std::pow(extent.maxCoeff(), 3))
    return "encloses no volume at rest";
  return {};
}

}  // namespace supple
