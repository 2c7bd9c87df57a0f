// Lists the edges of triangles so that those between the same vertices follow one another.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/meshes/mesh.h"

namespace supple {

struct TriangleEdge {
  std::int32_t low, high;  // its vertices
  std::int32_t triangle;
  std::int8_t side;  // of the triangle: 0 from corner 0 to 1, 1 from 1 to 2, 2 from 2 to 0
  bool upward;       // whether the triangle runs from low to high
};

// Returns three edges for each triangle, in the order of low, high, triangle and side. The numbers of vertices must
// not be negative.
std::vector<TriangleEdge> sorted_edges(const Triangles& triangles);

// Lists each edge once, at the first triangle that has it.
struct EdgesByTriangle {
  std::vector<std::array<std::int32_t, 2>> edges;  // two vertices, the lower one first
  std::vector<std::int32_t> begin;                 // where each triangle's edges begin, and the end

  std::span<const std::array<std::int32_t, 2>> of(std::int32_t triangle) const {
    const auto first = std::size_t(begin[std::size_t(triangle)]), end = std::size_t(begin[std::size_t(triangle) + 1]);
    return {edges.data() + first, end - first};
  }
};
EdgesByTriangle edges_by_triangle(const Triangles& triangles);

}  // namespace supple
