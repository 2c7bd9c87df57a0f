// Finds points of a shape's surface.
#pragma once

#include "geometry/shapes/shape.h"

namespace supple {

// Moves a point along the slope of the shape's field onto the shape's surface, and returns where it is then. A start
// that would have to move by `reach` or more stays where it is. The field must be smooth within `reach` of it [m].
Vec3 onto_surface(const Shape& shape, const Vec3& start, double reach);

}  // namespace supple
