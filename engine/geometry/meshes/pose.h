// Returns motions that move nothing, for the defaults of structs. They are functions in a unit of their own, because
// every unit that reads such a struct would otherwise compile Eigen's expressions again.
#pragma once

#include <Eigen/Geometry>

namespace supple {

Eigen::Isometry3d no_motion();
Eigen::Affine3d no_placement();

}  // namespace supple
