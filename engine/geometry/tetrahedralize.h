// Makes tetrahedra from a shape by isosurface stuffing (stuffed_lattice.h), at the spacing that gives the number of
// vertices which is asked for. The result is deterministic. The method is not meant for sharp edges, which come out
// rounded at the lattice's scale (box_mesh makes boxes).
#pragma once

#include <functional>

#include "geometry/mesh.h"
#include "geometry/shape.h"

namespace supple {

// Makes one connected manifold body with about `vertices` vertices (within 3 %, or 10 % where it is swollen); its
// regions follow the shape's tags. Throws InputError (naming `source`) if the shape is unbounded or empty, or too thin
// for that many vertices. A mesh is found in several attempts, the first of them 1; `heard` hears the share of an
// attempt that is done, 0 to 1. swell: how far the body reaches beyond a closed surface, in spacings of the lattice:
// with 1/2 each part of the surface is held by elements, however thin it is, and parts that are nearer to each other
// than a spacing hang together.
using MeshingProgress = std::function<void(int attempt, double share)>;
TetMesh tetrahedralize(const Shape& shape, int vertices, const std::string& source, const MeshingProgress& heard = {},
                       double swell = 0);

// Makes a box from the origin to `extent` with `cells` cells along each axis. Each cell is cut into six tetrahedra
// around one diagonal, mirrored from cell to cell so that no direction is preferred.
TetMesh box_mesh(const Vec3& extent, const Eigen::Vector3i& cells);

}  // namespace supple
