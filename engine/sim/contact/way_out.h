// Finds a common way out for a body that lies inside colliders. Its vertices cannot each leave by the surface that is
// closest to them: those on the two sides of a wall would leave in opposite directions, and the body would hang on it
// for ever.
#pragma once

#include <optional>

#include "sim/model/inputs.h"

namespace supple {

// Shows all colliders, where they stand at one time, as one obstacle. The colliders must outlive it.
class Obstacles {
 public:
  Obstacles(const std::vector<Collider>& colliders, std::vector<Eigen::Isometry3d> poses);

  std::size_t size() const { return colliders_.size(); }
  // Returns the signed distance to a collider's layer, in the world [m].
  double distance(std::size_t collider, const Vec3& point) const;
  // Returns the least signed distance to any collider's layer [m]; a point is inside where it is negative.
  double distance(const Vec3& point) const;
  // Returns the normal of the closest surface of the collider that a point is deepest in.
  Vec3 normal(const Vec3& point) const;
  // Returns a length that a point at a distance from all colliders can go without meeting one.
  double clear(double distance) const { return certainty_ * std::abs(distance); }
  const std::vector<Eigen::Isometry3d>& poses() const { return poses_; }

 private:
  const std::vector<Collider>& colliders_;
  std::vector<Eigen::Isometry3d> poses_, to_local_;
  double certainty_ = 1;
};

struct WayOut {
  Vec3 direction = Vec3::Zero();  // of unit length
  double distance = 0;            // how far the points must go [m]
};

// Finds a short straight way by which no point is left deeper than `tolerated` [m]. Directions that are tried are the
// normals where points are inside, their mean, and the axes of the world and of each collider; the shortest way of
// these is taken. Nothing when none of them leads out within `furthest` [m].
std::optional<WayOut> way_out(const Obstacles& obstacles, const Positions& points, double tolerated, double furthest);

}  // namespace supple
