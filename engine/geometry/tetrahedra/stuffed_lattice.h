// Stuffs a shape with the tetrahedra of a body-centred cubic lattice of one spacing (Labelle and Shewchuk 2007,
// "Isosurface stuffing"): lattice points too close to the shape's surface are moved onto it, and the tetrahedra that it
// then still crosses are cut at it, so that the dihedral angles stay between about 10.7 and 165 degrees. Not here:
// which spacing gives how many vertices (tetrahedralize.h).
#pragma once

#include <functional>

#include "base/threads.h"
#include "geometry/meshes/mesh.h"
#include "geometry/shapes/shape.h"

namespace supple {

// Makes one connected manifold body without tags. spacing: the spacing of the lattice [m]. shift: the shift of the
// lattice against the shape, in spacings. swell: how far the body reaches beyond the shape [m]. heard: a function that
// is told the share that is done, 0 to 1.
TetMesh stuffed_lattice(const Shape& shape, double spacing, const Vec3& shift, double swell,
                        const std::function<void(double)>& heard, Threads& threads);

}  // namespace supple
