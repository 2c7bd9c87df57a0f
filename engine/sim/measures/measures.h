// Computes numbers for reports that describe a pose: stretch, inverted elements, jiggle, penetration. They are measured
// outside the step, so their time does not count as the step's.
#pragma once

#include <Eigen/Geometry>

#include "base/threads.h"
#include "sim/model/inputs.h"
#include "sim/model/model.h"

namespace supple {

inline constexpr double without_volume = 1e-3;  // an element below this share of its rest volume has collapsed

struct Deformation {
  double stretch = 1;  // 99.9th percentile over elements of the largest stretch, weighted by rest volume or
                       // area; for springs, current over rest length, weighted by rest length
  int inverted = 0;    // tetrahedra with det F < 0 whose rest volume is above 1e-6 of the mean
  int collapsed = 0;   // tetrahedra with |det F| < without_volume whose rest volume is above the same bound
};
// Returns the deformation at x, n x 3 in the model's order. threads: null for the calling one alone.
Deformation deformation(const Model& model, const Positions& x, Threads* threads = nullptr);

// Tells whether any tetrahedra are inverted or collapsed.
bool is_tangled(const Model& model, const Positions& x);

// Returns how deep the deepest point of a surface lies below each collider's own surface, without the collider's layer
// [m]; 0 where no point lies below. Edges and faces between vertices count (geometry/shapes/triangle_in_shape.h).
// triangles: vertices by row of x.
std::vector<double> penetrations(const std::vector<Collider>& colliders, const std::vector<ColliderMotion>& motions,
                                 const Positions& x, const Triangles& triangles);
// Returns the largest of penetrations(), which is found faster alone.
double penetration(const std::vector<Collider>& colliders, const std::vector<ColliderMotion>& motions,
                   const Positions& x, const Triangles& triangles);

// Returns the places on a surface that lie deeper than `depth` in a collider and deeper than the corners of their
// triangle.
std::vector<Vec3> deep_places(const Collider& collider, const Eigen::Isometry3d& pose, const Positions& x,
                              const Triangles& triangles, double depth);

// Returns the largest distance between a position and the rest position under `motion` (the handle's), over the body's
// size.
double jiggle(const Model& model, const Positions& x, const Eigen::Isometry3d& motion);

}  // namespace supple
