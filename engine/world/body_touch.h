// Describes how bodies touched each other in a step.
#pragma once

#include <cstddef>

#include "base/types.h"

namespace supple {

// Tells how two bodies touched each other, or one touched itself, at the end of a step.
struct BodyTouch {
  std::size_t a, b;           // the bodies, the earlier one first; equal where a body touched itself
  int contacts = 0;           // number of contacts in which the two touch, of vertices and of edges
  double depth = 0;           // of the deepest of these contacts, from the surface that is touched [m]
  Vec3 force = Vec3::Zero();  // of a on b [N]
  double pressing = 0;        // sum of the sizes of the contacts' forces [N]
  Vec3 place = Vec3::Zero();  // mean of the places of the contacts, weighted by their forces [m]
};

}  // namespace supple
