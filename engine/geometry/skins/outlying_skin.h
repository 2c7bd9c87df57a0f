// Chooses which mesh vertices carry the parts of a skin that lie in no element, and with which shares.
//
// A point outside follows the boundary point that is closest to it, found by a walk over the boundary that starts where
// the skin's edges lead into the solid: what is near but not joined never counts. Then shares are averaged over
// neighbouring points of the skin, the more widely the further outside a point lies, so that they change smoothly where
// the closest point jumps, and a little everywhere, so that the elements' kinks do not show.
#pragma once

#include <vector>

#include "geometry/meshes/mesh.h"

namespace supple {

struct Carrier {
  std::int32_t vertex;  // of the mesh
  double share;         // none is negative, and those of a point sum to 1
};

// Names the element in which each point of the skin lies, or the one from which it is least far outside.
struct Located {
  Tetrahedra corners;                                                 // n x 4
  Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor> weights;  // barycentric, n x 4
  std::vector<char> inside;                                           // by point
};

// Returns the mesh vertices that carry each skin vertex, in increasing order; none where it follows its element alone.
std::vector<std::vector<Carrier>> outside_carriers(const TriMesh& skin, const TetMesh& mesh, const Located& located);

}  // namespace supple
