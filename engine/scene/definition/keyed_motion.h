// Defines rigid motions that are given by keys.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Geometry>

#include "base/names.h"
#include "base/types.h"

namespace supple {

struct MotionKey {
  double time = 0;                // [s]
  Vec3 move = Vec3(0, 0, 0);      // displacement from rest [m]
  Vec3 turn_deg = Vec3(0, 0, 0);  // rotation about the handle's centre, or the collider's origin
};

enum class Ease { smooth, linear };
template <>
struct Names<Ease> {
  static constexpr std::array table = {Name{Ease::smooth, "smooth"}, Name{Ease::linear, "linear"}};
};

// Moves an object that the scene file places at rest.
struct KeyedMotion {
  Vec3 center = Vec3(0, 0, 0);  // the point that keys turn about [m]
  Ease ease = Ease::smooth;
  std::vector<MotionKey> keys;

  // Returns the rigid motion from rest at a time [s].
  Eigen::Isometry3d at(double time) const;
};

}  // namespace supple
