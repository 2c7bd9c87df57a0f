// Describes what a piece of cloth is made of: its vertices, its drawn triangles, and the pairs of vertices that are
// joined. It does not say how stiff the threads are (scene/) or what a spring does (sim/elements/spring.h).
#pragma once

#include <array>
#include <vector>

#include "geometry/meshes/mesh.h"

namespace supple {

using VertexPair = std::array<std::int32_t, 2>;

struct ClothMesh {
  TriMesh surface;
  std::vector<VertexPair> edges;      // along the threads of a grid; all edges of a triangle mesh
  std::vector<VertexPair> diagonals;  // one for each cell of a grid, in alternating directions
  // These pairs resist bending: every other vertex of a grid's rows and columns; in a triangle mesh, the far corners of
  // two triangles that share an edge.
  std::vector<VertexPair> bends;
};

// Builds a grid of cells.x() by cells.y() in the plane z = 0, from the origin to `extent` [m]. Its diagonals alternate
// like a chequerboard so that no direction is preferred (Liu et al. 2013, "Fast simulation of mass-spring systems").
ClothMesh cloth_grid(const Eigen::Vector2d& extent, const Eigen::Vector2i& cells);

// Makes a shell of any triangle mesh.
ClothMesh cloth_of(TriMesh surface);

// Returns, for each vertex, a third of the area of its triangles [m^2].
std::vector<double> vertex_areas(const TriMesh& surface);

}  // namespace supple
