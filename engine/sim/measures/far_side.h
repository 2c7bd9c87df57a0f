// Measures how much of a body is on the far side of a thin collider. Neither contacts nor depths show this: a vertex
// that came through a plate touches nothing there, and the depth in a plate that is thin beside the body is never
// large. The body's surface shows it: edges that pass through the plate cut a part of the surface off from the rest. A
// body that reaches around the rim of a plate has vertices on both sides too, but its surface leads around the rim from
// one to the other. Not here: depths in colliders (measures.h).
#pragma once

#include "sim/model/inputs.h"
#include "sim/model/model.h"

namespace supple {

// A collider whose half thickness is more than this, over the body's size, is thick: depths tell of it.
inline constexpr double thin_half_thickness = 0.01;

// Returns how far the parts of the surface that a thin collider cuts off reach out of the collider on the far side; 0
// where there are no such parts, and where the collider is thick or its thickness is not known [m]. Of two parts that a
// cut edge would join, the smaller one is on the far side. pose: the pose of the collider. x: n x 3 in the model's
// order.
double reach_on_far_side(const Model& model, const Collider& collider, const Eigen::Isometry3d& pose,
                         const Positions& x);

}  // namespace supple
