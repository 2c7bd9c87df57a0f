// Motions that move nothing, for the defaults of structs. They are functions of a unit of their own, because Eigen's
// expressions would be compiled anew in every unit that reads such a struct.
#pragma once

#include <Eigen/Geometry>

namespace supple {

Eigen::Isometry3d no_motion();
Eigen::Affine3d no_placement();

}  // namespace supple
