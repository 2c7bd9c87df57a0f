// Measures how deep two meshes are in each other: the largest depth of a vertex of one mesh's surface inside the other,
// where depth is the distance from the other's surface. This is an estimate: where only edges cross faces, no vertex is
// inside, and the depth is 0. Not here: whether two meshes share space at all (geometry/meshes/shared_space.h).
#pragma once

#include "geometry/meshes/shared_space.h"

namespace supple {

struct SharedDepth {
  double depth = 0;            // [m]
  Vec3 place = Vec3(0, 0, 0);  // the vertex that is deepest [m]; of no meaning where the depth is 0
};

// Returns the largest depth of a vertex of one mesh inside the other. A cloth has no elements: vertices of it may be
// inside the other mesh, and no vertex is inside the cloth.
SharedDepth shared_depth(const PosedMesh& a, const PosedMesh& b);

}  // namespace supple
