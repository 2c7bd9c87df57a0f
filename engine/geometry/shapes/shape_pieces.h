// Takes a shape apart into pieces that are simpler to search: the parts of a union, each of them a shape in the same
// frame. Their union is the shape. A blend, a cut or a mirrored copy stays one piece.
#pragma once

#include <vector>

#include "geometry/shapes/shape.h"

namespace supple {

struct ShapePiece {
  Shape shape;
  // The smallest radius of curvature where the surface bulges: 0 at edges, infinite where it is flat or where it is not
  // bent outward; 0 also where it is not known [m].
  double bulge = 0;
  double half_thickness = 0;  // Shape::half_thickness [m]
  bool convex = false;        // false also where it is not known
};

std::vector<ShapePiece> pieces_of(const Shape& shape);

}  // namespace supple
