// Finds the convex hull of points in a plane.
#pragma once

#include <vector>

#include "base/types.h"

namespace supple {

// Returns the corners of the hull, anticlockwise; of fewer than three points, the points themselves.
std::vector<Eigen::Vector2d> hull_of(std::vector<Eigen::Vector2d> points);

}  // namespace supple
