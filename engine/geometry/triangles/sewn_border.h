// Joins vertices on the open border of a surface that lie a little apart, such as those of the pieces of a garment
// whose seams are not closed. What lies at the same place is joined by welded_surface.h.
#pragma once

#include "geometry/meshes/mesh.h"

namespace supple {

struct SewnSurface {
  TriMesh mesh;         // its triangles are those of the input, in their order
  long joined = 0;      // how many border vertices became one with another
  double furthest = 0;  // how far two of them were apart, at most [m]
  long left = 0;        // vertices on the border of the new surface
  long beside = 0;      // how many of these are within the distance of a border edge that is not theirs
};

// Makes one vertex of two on the border that are within `distance` [m] and each the nearest one to the other; two that
// an edge joins stay two. This is repeated on the new border while there are such pairs, so that several pieces may
// meet in one vertex, which lies in the mean of all that it stands for. All triangles stay, between the new vertices.
SewnSurface sewn_border(const TriMesh& surface, double distance);

}  // namespace supple
