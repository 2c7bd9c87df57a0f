// Makes large triangles of a surface small enough to bend with elements: a flat face of a CAD model has vertices at its
// corners alone, and so could only tilt.
#pragma once

#include <array>
#include <cstdint>

#include "geometry/meshes/mesh.h"

namespace supple {

struct RefinedSurface {
  TriMesh mesh;                                   // the first vertices are those of the surface
  std::vector<std::int32_t> parent;               // by triangle: the one that it is a part of
  std::vector<std::array<std::int32_t, 2>> ends;  // by vertex after the first ones: the two in whose middle it lies
};

// Halves edges that are longer than `longest` [m] until none is. Both triangles at an edge meet in its midpoint, so no
// gap can open between them, and the parts of a triangle lie in its plane. Stops before the surface has more than
// `most` triangles.
RefinedSurface refined(const TriMesh& surface, double longest, Eigen::Index most);

}  // namespace supple
