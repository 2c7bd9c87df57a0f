// Defines the answer to the question where a solid's surface is nearest.
#pragma once

#include "base/types.h"

namespace supple {

// Describes the point of a solid's surface that is closest to a query point.
struct SurfacePoint {
  Vec3 point;       // the surface's closest point [m]
  Vec3 normal;      // of unit length, from inside to outside
  double distance;  // from the query point, negative inside [m]
};

}  // namespace supple
