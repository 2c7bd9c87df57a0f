// Makes the surfaces of plates, rings, rods and balls with round edges: all of them are the convex hull of some points
// in a plane, made wider and given a height.
#pragma once

#include <vector>

#include "geometry/meshes/mesh.h"

namespace supple {

// Describes a prism over the plane of the first two coordinates [m].
struct RoundedPrism {
  std::vector<Eigen::Vector2d> points;  // the prism stands on their convex hull; at least one
  double margin = 0;                    // how far the prism reaches beyond that hull, all around
  double low = 0, high = 1;             // the range of the third coordinate
  double bevel = 0;                     // radius of its upper and lower edges: at most the margin and half the height
};

// Returns the closed surface. One point gives a ball and two a rod where margin, bevel and half the height are the
// same.
TriMesh surface_of(const RoundedPrism& prism);

}  // namespace supple
