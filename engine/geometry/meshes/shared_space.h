// Tells whether two meshes are partly in the same place. They are where an edge of one passes through a triangle of the
// other, and where a vertex of one is inside an element of the other, as it is when one mesh lies whole within the
// other. Meshes that touch, on a face, an edge or a point, do not share space. Not here: how deep they are in each
// other (geometry/triangles/shared_depth.h), and which bodies of a scene share space, and since when
// (scene/building/body_passings.h, body_depths.h).
#pragma once

#include "geometry/meshes/mesh.h"

namespace supple {

// Describes a mesh in a pose. What it refers to must outlive it.
struct PosedMesh {
  const Positions& points;   // n x 3 [m]
  const Triangles& surface;  // m x 3: the corners of each triangle, as rows of `points`
  const Tetrahedra& tets;    // the corners of each element, in the same way; without rows for a cloth
  Bounds box = bounds_of(points);
};

// Tells whether the meshes share space. A space that is thinner than a ten-millionth of the smaller mesh does not
// count. Where a mesh fits into another with less play than that on two sides, the answer is uncertain.
bool share_space(const PosedMesh& a, const PosedMesh& b);

}  // namespace supple
