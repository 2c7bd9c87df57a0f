// Defines springs and triangles of cloth as a body lists them, in the numbering of its mesh. Not here: their energies
// (spring.h, triangle.h).
#pragma once

#include <array>
#include <cstdint>

namespace supple {

struct Spring {
  std::int32_t from, to;  // vertices of the mesh, in its own numbering
  double length;          // the rest length [m]
  double stiffness;       // [N/m]
};

// Describes a triangle of cloth as it lies in the flat pattern, where the first direction is that of the warp.
struct FlatTriangle {
  std::array<std::int32_t, 3> corner;  // vertices of the mesh, in its own numbering
  double edges[4];                     // from corner 0 to corners 1 and 2, as columns of a matrix, row by row [m]

  double area() const { return 0.5 * (edges[0] * edges[3] - edges[1] * edges[2]); }  // above 0 [m^2]
};

}  // namespace supple
