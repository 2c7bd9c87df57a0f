// Tetrahedra from a shape by isosurface stuffing (Labelle and Shewchuk 2007): a body-centred cubic lattice is cut at
// the surface, after lattice points too near to the surface were moved onto it, so that the dihedral angles stay
// between about 10.7 and 165 degrees whatever the surface does. Deterministic. Not for sharp edges: they come out
// rounded at the lattice's scale (boxes: box_mesh).
#pragma once

#include "geometry/mesh.h"
#include "geometry/shape.h"

namespace supple {

// One connected manifold body with about `vertices` vertices (within 3 %), regions from the shape's tags.
// Throws InputError (naming `source`) if the shape is unbounded or empty, or too thin for that many vertices.
TetMesh tetrahedralize(const Shape& shape, int vertices, const std::string& source);

// The same at a given lattice spacing [m]; `shift` (fractions of the spacing) moves the lattice against the shape.
TetMesh stuff_lattice(const Shape& shape, double spacing, const Vec3& shift = Vec3::Zero());

// A box from the origin to `extent`, in cells of `cells` a side, each cut into six tetrahedra around one diagonal,
// mirrored from cell to cell so that no direction is preferred.
TetMesh box_mesh(const Vec3& extent, const Eigen::Vector3i& cells);

}  // namespace supple
