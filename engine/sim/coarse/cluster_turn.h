// Describes how a cluster moves, to first order in the motion.
#pragma once

#include "base/types.h"

namespace supple {

struct ClusterTurn {
  Vec3 angle = Vec3::Zero();   // the angle by which the cluster turns [rad]
  Mat3 strain = Mat3::Zero();  // the symmetric rest of the gradient of the motion
  Vec3 normal = Vec3::Zero();  // normal of a cluster of cloth, along which the strain is not known; 0 for solids
  double stiffness = 0;        // the integral of k over the cluster [J]
};

}  // namespace supple
