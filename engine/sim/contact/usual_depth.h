// Limits how deep a point of a body may be in a collider or in another body, at an impact and where contact presses it.
// Beyond half the thickness of a plate, the point would belong to the other side from the next step on, and hang there
// for ever.
#pragma once

#include <algorithm>
#include <limits>

#include "sim/model/inputs.h"

namespace supple {

// Returns the depth in another body, or in a collider that is thick beside the body [m]. size: the size of the body, or
// of the smaller of two [m].
inline double usual_depth(double size) { return 0.004 * size; }

// Returns the largest depth that a thin collider allows any body: a quarter of half its thickness, layer included [m].
// half_thickness: half the thickness of the collider's shape [m]; 0 where it is not known, which allows every depth.
inline double most_depth(const Collider& collider, double half_thickness) {
  if (half_thickness <= 0) return std::numeric_limits<double>::infinity();
  return 0.25 * (half_thickness + collider.thickness);
}

// Returns the depth in any collider [m]. size: the size of the body [m].
inline double usual_depth(double size, const Collider& collider, double half_thickness) {
  return std::min(usual_depth(size), most_depth(collider, half_thickness));
}

}  // namespace supple
