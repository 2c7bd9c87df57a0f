// What a lattice cut leaves behind now and then: crumbs, and places where the surface touches itself.
#pragma once

#include "geometry/mesh.h"

namespace supple {

// The largest face-connected piece, with the elements removed at which its boundary is not a manifold (the smaller side
// of each touch).
TetMesh one_manifold_piece(TetMesh mesh);

}  // namespace supple
