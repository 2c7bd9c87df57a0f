// Finds points of a shape's surface.
#pragma once

#include "geometry/shapes/shape.h"

namespace supple {

// Moves a point along the slope of the shape's field onto its surface. It stays where that is farther away than
// `reach`, within which the field must be smooth [m].
Vec3 onto_surface(const Shape& shape, const Vec3& point, double reach);

}  // namespace supple
