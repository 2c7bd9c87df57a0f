// What a pose looks like in numbers, for reports: stretch, inverted elements, jiggle, energies. Outside the step, so
// not in its time.
#pragma once

#include <Eigen/Geometry>

#include <optional>

#include "sim/solver/objective.h"

namespace supple {

struct Deformation {
  double stretch = 1;           // 99.9th percentile over elements of the largest stretch, weighted by rest volume; of
                                // springs, of current over rest length, weighted by rest length
  std::optional<int> inverted;  // tetrahedra with det F < 0 whose rest volume is above 1e-6 of the mean; none for cloth
};
Deformation deformation(const Model& model, const Positions& x);

struct Energies {
  double kinetic = 0, elastic = 0, gravitational = 0;  // the last one against the rest shape [J]
  double total() const { return kinetic + elastic + gravitational; }
};
// Springs of soft handles are not counted. Evaluates all elements; workspace: scratch that knows the model.
Energies energies(const Model& model, const State& state, const Vec3& gravity, Workspace& workspace);

// The deepest point of a surface below a collider's own (its thickness does not count): vertices, edge midpoints and
// face centres [m]; 0 when none. triangles: vertices by row of x.
double penetration(const std::vector<Collider>& colliders, const std::vector<ColliderMotion>& motions,
                   const Positions& x, const Triangles& triangles);

// The largest distance between a position and the rest position under `motion` (the handle's), over the body's size.
double jiggle(const Model& model, const Positions& x, const Eigen::Isometry3d& motion);

}  // namespace supple
