// Removes two defects that a cut lattice sometimes has: small loose pieces, and places where the surface touches
// itself.
#pragma once

#include "geometry/meshes/mesh.h"

namespace supple {

// Returns the largest face-connected piece, without the elements at which its boundary is not a manifold (the smaller
// side of each place where it touches itself).
TetMesh one_manifold_piece(TetMesh mesh);

}  // namespace supple
