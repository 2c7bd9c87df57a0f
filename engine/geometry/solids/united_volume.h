// Measures the volume inside closed surfaces that overlap or lie in one another: what is inside twice counts once.
#pragma once

#include "geometry/meshes/mesh.h"

namespace supple {

// Returns the volume where the winding number is positive, by columns through the surface, some 250 across: exact along
// a column, so that errors are some thousandths. boundary: closed, facing outward, cavities facing into themselves.
double united_volume(const TriMesh& boundary);

}  // namespace supple
