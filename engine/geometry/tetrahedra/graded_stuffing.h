// Stuffs a shape with tetrahedra that are smaller where it is thin, and swells it there a little where that is not
// enough, so that thin parts are not lost. As in stuffed_lattice.h, lattice points near the surface are moved onto it
// and the elements are cut there (Labelle and Shewchuk 2007), but the lattice is a bisected one (bisected_lattice.h).
// The dihedral angles that the paper proves hold for a uniform lattice alone.
#pragma once

#include <functional>
#include <vector>

#include "base/threads.h"
#include "geometry/meshes/mesh.h"
#include "geometry/shapes/shape.h"
#include "geometry/triangles/surface_thickness.h"

namespace supple {

// Makes one connected manifold body without tags. spacing: the spacing of the lattice where the shape is thick [m];
// where it is thin, half of that. shift: the shift of the lattice against the shape, in spacings. thickness: samples of
// all of the surface. swollen_to: where the shape is thinner than this many spacings of the elements there, it is
// swollen to as many: a plate needs about 1 to hold a layer of elements, a rod in any direction 1.5. heard: a function
// that is told the share that is done, 0 to 1.
TetMesh graded_stuffing(const Shape& shape, double spacing, const Vec3& shift,
                        const std::vector<ThicknessSample>& thickness, double swollen_to,
                        const std::function<void(double)>& heard, Threads& threads);

}  // namespace supple
