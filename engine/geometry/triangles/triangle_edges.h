// Lists the edges of triangles so that those between the same vertices follow one another.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/meshes/mesh.h"

namespace supple {

struct TriangleEdge {
  std::int32_t low, high;  // its vertices
  std::int32_t triangle;
  std::int8_t side;  // of the triangle: 0 from corner 0 to 1, 1 from 1 to 2, 2 from 2 to 0
  bool upward;       // whether the triangle runs from low to high
};

// Returns three edges for each triangle, in the order of low, high, triangle and side. The vertices' names must not be
// negative.
std::vector<TriangleEdge> sorted_edges(const Triangles& triangles);

}  // namespace supple
