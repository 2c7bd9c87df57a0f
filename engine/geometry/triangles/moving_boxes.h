// Compares boxes that move evenly, for the queries of a MovingSurface: four boxes at a time, one in each lane.
#pragma once

#include <limits>

#include "base/types.h"

namespace supple {

// Returns by how much each of four boxes that move is beyond another box, along the axis on which it is furthest
// beyond; not positive where they meet.
template <class Boxes>
auto gaps(const Boxes& start, const Boxes& end, const Vec3& carried, const Bounds& box) {
  auto most = Boxes::Lanes::Constant(-infinity).eval();
  for (int axis = 0; axis < 3; ++axis) {
    const auto k = std::size_t(axis);
    const auto lower = start.lower[k].min(end.lower[k] - carried[axis]);
    const auto upper = start.upper[k].max(end.upper[k] - carried[axis]);
    most = most.max(lower - box.upper[axis]).max(box.lower[axis] - upper);
  }
  return most;
}

// Returns the box around four boxes.
template <class Boxes>
Bounds whole_box(const Boxes& boxes) {
  const auto &l = boxes.lower, &u = boxes.upper;
  return {Vec3(l[0].minCoeff(), l[1].minCoeff(), l[2].minCoeff()),
          Vec3(u[0].maxCoeff(), u[1].maxCoeff(), u[2].maxCoeff())};
}

// Returns the box in which a point moves from a to b, in the frame that moves by `carried`, and a margin [m] around it.
inline Bounds box_of_path(const Vec3& a, const Vec3& b, const Vec3& carried, double margin) {
  const Vec3 end = b - carried;
  return {a.cwiseMin(end).array() - margin, a.cwiseMax(end).array() + margin};
}

// Returns by how much coordinates of this size may be wrong after a difference or two.
inline double roundoff_at(const Vec3& a, const Vec3& b) {
  return 4 * std::numeric_limits<double>::epsilon() * a.cwiseAbs().cwiseMax(b.cwiseAbs()).maxCoeff();
}

}  // namespace supple
