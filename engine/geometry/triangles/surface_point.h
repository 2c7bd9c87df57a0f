// Describes the point of a solid's surface that is closest to a query point.
#pragma once

#include "base/types.h"

namespace supple {

struct SurfacePoint {
  Vec3 point;       // the surface's closest point [m]
  Vec3 normal;      // of unit length, from inside to outside
  double distance;  // from the query point, negative inside [m]
};

}  // namespace supple
