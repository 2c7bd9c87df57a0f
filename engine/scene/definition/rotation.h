// Computes rotations from angles in the form that scene files have.
#pragma once

#include <Eigen/Geometry>
#include <numbers>

#include "base/types.h"

namespace supple {

// Returns the rotation by these degrees about the fixed axes x, then y, then z.
inline Eigen::Quaterniond rotation_from_degrees(const Vec3& degrees) {
  const Vec3 angle = degrees * (std::numbers::pi / 180);
  return Eigen::AngleAxisd(angle.z(), Vec3::UnitZ()) * Eigen::AngleAxisd(angle.y(), Vec3::UnitY()) *
         Eigen::AngleAxisd(angle.x(), Vec3::UnitX());
}

}  // namespace supple
