// Makes tetrahedra from a shape by isosurface stuffing (Labelle and Shewchuk 2007): lattice points too close to the
// surface are moved onto it, and then a body-centred cubic lattice is cut at the surface, so that the dihedral angles
// stay between about 10.7 and 165 degrees for every surface. The result is deterministic. The method is not meant for
// sharp edges, which come out rounded at the lattice's scale (box_mesh makes boxes).
#pragma once

#include <functional>

#include "geometry/mesh.h"
#include "geometry/shape.h"

namespace supple {

// Makes one connected manifold body with about `vertices` vertices (within 3 %); its regions follow the shape's tags.
// Throws InputError (naming `source`) if the shape is unbounded or empty, or too thin for that many vertices. A mesh is
// found in several attempts, the first of them 1; `heard` hears the share of an attempt that is done, 0 to 1.
using MeshingProgress = std::function<void(int attempt, double share)>;
TetMesh tetrahedralize(const Shape& shape, int vertices, const std::string& source, const MeshingProgress& heard = {});

// Does the same at a given lattice spacing [m]; `shift` (in fractions of the spacing) moves the lattice against the
// shape. heard: hears the share that is done.
TetMesh stuff_lattice(const Shape& shape, double spacing, const Vec3& shift = Vec3::Zero(),
                      const std::function<void(double)>& heard = {});

// Makes a box from the origin to `extent` with `cells` cells along each axis. Each cell is cut into six tetrahedra
// around one diagonal, mirrored from cell to cell so that no direction is preferred.
TetMesh box_mesh(const Vec3& extent, const Eigen::Vector3i& cells);

}  // namespace supple
