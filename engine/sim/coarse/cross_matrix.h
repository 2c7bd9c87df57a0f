// Defines the matrix of a cross product.
#pragma once

#include "base/types.h"

namespace supple {

// Returns the matrix that takes v to s x v.
inline Mat3 cross_matrix(const Vec3& s) {
  Mat3 m;
  m << 0, -s.z(), s.y(), s.z(), 0, -s.x(), -s.y(), s.x(), 0;
  return m;
}

}  // namespace supple
