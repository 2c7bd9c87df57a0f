// Gives sheets a thickness, so that they enclose a volume.
#pragma once

#include "geometry/triangles/numbered_surface.h"

namespace supple {

struct Thickened {
  TriMesh boundary;  // closed, each part facing outward; parts may overlap
  Eigen::Index sheets = 0;
};

// Replaces each part that has a rim by two copies of itself, half the thickness to either side along the normals of its
// vertices, with a strip around the rim. Edges with more than two triangles, and those where a one-sided surface turns
// over, count as rims. Closed parts stay as they are.
Thickened thickened(const Numbered& surface, double thickness);

}  // namespace supple
