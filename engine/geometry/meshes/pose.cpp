#include "geometry/meshes/pose.h"

namespace supple {

Eigen::Isometry3d no_motion() { return Eigen::Isometry3d::Identity(); }
Eigen::Affine3d no_placement() { return Eigen::Affine3d::Identity(); }

}  // namespace supple
