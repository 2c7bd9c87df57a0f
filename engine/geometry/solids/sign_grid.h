// Samples where triangles have an inside, on a grid, and makes a closed surface around that. The inside is where the
// generalised winding number exceeds 1/2, so that holes, overlaps and triangles inside do not matter.
#pragma once

#include "base/threads.h"
#include "geometry/triangles/surface_nets.h"
#include "geometry/triangles/triangle_soup.h"

namespace supple {

struct SignGrid : PointGrid {
  std::vector<char> inside;  // 1: inside; by point
};

// Returns an edge of the cells that puts some 40,000 of them on the triangles' area, within bounds for the whole grid.
double suitable_cell(const TriMesh& mesh);

// Returns the points of a grid, each with its side. Every point near a triangle is sampled, and elsewhere only blocks
// of points in which the side may change. At least the two outermost layers are outside.
SignGrid sampled_signs(const TriangleSoup& soup, double cell, Threads& threads);

// Adds points to the inside until its boundary is a manifold: no two points of the inside touch along a diagonal of the
// grid alone. Such sets are called well-composed: Latecki, 3D well-composed pictures, Graphical Models and Image
// Processing 59, 1997.
void make_well_composed(SignGrid& grid);

// Returns the boundary of the inside as a closed manifold surface that faces outward, with one vertex in the middle of
// each cell that it crosses (surface_nets.h). The inside must be well-composed.
TriMesh boundary_of(const SignGrid& grid);

}  // namespace supple
