// A point of a solid's surface, as seen from somewhere.
#pragma once

#include "base/types.h"

namespace supple {

struct SurfacePoint {
  Vec3 point;       // the surface's closest point [m]
  Vec3 normal;      // of unit length, from inside to outside
  double distance;  // to it, negative inside [m]
};

}  // namespace supple
