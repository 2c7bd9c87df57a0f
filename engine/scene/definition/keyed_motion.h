// Defines rigid motions that are given by keys.
#pragma once

#include <Eigen/Geometry>

#include "scene/definition/scene_def.h"

namespace supple {

// Moves an object that the scene file places at rest.
struct KeyedMotion {
  Vec3 center = Vec3(0, 0, 0);  // the point that keys turn about [m]
  Ease ease = Ease::smooth;
  std::vector<MotionKey> keys;

  // Returns the rigid motion from rest at a time [s].
  Eigen::Isometry3d at(double time) const;
};

}  // namespace supple
