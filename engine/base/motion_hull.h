// Keeps the outermost points of a motion: the furthest one in each of some four hundred directions. A camera that shows
// these shows all of the motion, but for less than a hundredth of its size, and they are few enough for a run's record.
#pragma once

#include <span>
#include <vector>

#include "base/types.h"

namespace supple {

class MotionHull {
 public:
  void include(const Vec3& point);
  void include(const Positions& points);

  // Returns the outermost points, each once.
  std::vector<Vec3> points() const;

 private:
  std::vector<Vec3> furthest_;  // by direction
  std::vector<double> reach_;   // by direction: how far its furthest point is along it [m]
};

// Returns the corners of a box; none where it is empty.
std::vector<Vec3> corners_of(const Bounds& box);

// Returns the box around points.
Bounds box_around(std::span<const Vec3> points);

}  // namespace supple
