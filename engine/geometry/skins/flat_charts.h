// Lays curved surfaces flat in pieces, for what is printed or woven on them.
#pragma once

#include <array>
#include <vector>

#include "geometry/meshes/mesh.h"

namespace supple {

// Holds the places of a triangle's corners on the flat cloth [m].
using LaidTriangle = std::array<Eigen::Vector2d, 3>;

// Names the two axes along which something is printed on a face with this normal: the ones that it faces least.
struct PrintAxes {
  int across, along;
  bool operator==(const PrintAxes&) const = default;
};
PrintAxes print_axes(const Vec3& normal);

// Returns the places of all triangles. The surface has an axis, the one that it faces least, as a garment has the one
// of the body that wears it. Walls, which face away from the axis, are laid flat around it: lines of the print run
// along the axis and around it, and come as near to their true distances as they can where the surface widens or
// narrows (least squares). A wall that is closed around the axis has a seam on its back, where a vertex has two places,
// and one from each further hole. Caps, which face along the axis, are seen from there, and so are walls with more than
// 500,000 places and those whose triangles are too thin for the least squares. points: n x 3 [m]; triangles hang
// together by edges of two triangles.
std::vector<LaidTriangle> laid_triangles(const Positions& points, const Triangles& triangles);

}  // namespace supple
