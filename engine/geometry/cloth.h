// What a piece of cloth is woven from: its vertices, its drawn triangles, and which pairs of vertices are joined. Not
// here: how stiff the threads are (scene/), what a spring does (sim/elements/spring.h).
#pragma once

#include <array>
#include <vector>

#include "geometry/mesh.h"

namespace supple {

using VertexPair = std::array<std::int32_t, 2>;

struct ClothMesh {
  TriMesh surface;
  std::vector<VertexPair> edges;      // along the threads; of a triangle mesh, all its edges
  std::vector<VertexPair> diagonals;  // of a grid: one a cell, alternating
  std::vector<VertexPair> bends;  // across an edge: every other vertex of a grid's rows and columns, the far corners of
                                  // two triangles
};

// A grid of cells.x() by cells.y() in the plane z = 0, from the origin to `extent` [m], its diagonals alternating like
// a chequerboard so that no direction is preferred (Liu et al. 2013, "Fast simulation of mass-spring systems").
ClothMesh cloth_grid(const Eigen::Vector2d& extent, const Eigen::Vector2i& cells);

// A shell of any triangle mesh.
ClothMesh cloth_of(TriMesh surface);

// By vertex, a third of the area of its triangles. [m^2]
std::vector<double> vertex_areas(const TriMesh& surface);

}  // namespace supple
