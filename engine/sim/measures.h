// What a pose looks like in numbers, for reports: stretch and jiggle. Outside the step, so not in its time.
#pragma once

#include <Eigen/Geometry>

#include "sim/state.h"

namespace supple {

// The volume-weighted 99.9th percentile over elements of the largest stretch (singular value of F).
double stretch(const Model& model, const Positions& x);

// The largest distance between a position and the rest position under `motion` (the handle's), over the body's size.
double jiggle(const Model& model, const Positions& x, const Eigen::Isometry3d& motion);

}  // namespace supple
