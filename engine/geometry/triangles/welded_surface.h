// Joins the vertices of any triangle surface that are at the same place: an STL file repeats each vertex for each of
// its triangles, and an OBJ file does so along the seams of its texture. No vertex moves by more than the tolerance, no
// hole is closed and nothing is turned over; solids/closed_surface.h and triangles/remesh.h do more.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "geometry/meshes/mesh.h"

namespace supple {

struct WeldedSurface {
  TriMesh mesh;                               // every vertex is in a triangle, and every triangle has an area
  std::vector<std::int32_t> vertex_source;    // by vertex: one of the vertices that became it
  std::vector<std::int32_t> vertex_target;    // by vertex of the input: the one that it became; -1: none
  std::vector<std::int32_t> triangle_source;  // by triangle: the one that it was or is a part of
  // By triangle and corner: the vertex of the input that its source has there; -1: none, because a vertex of another
  // triangle lies there on a side of the source.
  std::vector<std::array<std::int32_t, 3>> corner_source;
};

// Makes one vertex of those that are within `tolerance` [m] of each other: each vertex joins the nearest of the earlier
// ones that are still there, so that a chain of near vertices does not shrink to one. A tolerance of 0 joins vertices
// at the same position. Leaves out triangles without area, those that repeat others, and vertices without triangles.
// Where a corner of a triangle without area lies on its longest side, the triangle beyond that side is cut in two
// there, so that no crack opens. Throws InputError, with this name, where the tolerance is negative or not finite,
// where the surface has no triangle with an area, and where indices are out of range or positions are not finite.
WeldedSurface welded(const TriMesh& surface, double tolerance, const std::string& name);

// Returns the edges at which two triangles named different vertices before they were joined, two vertices of the welded
// mesh each, the lower one first and in increasing order. These are the seams of a texture, and all edges of an STL
// file.
std::vector<std::array<std::int32_t, 2>> former_seams(const WeldedSurface& joined);

}  // namespace supple
