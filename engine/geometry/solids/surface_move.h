// Describes how the surface of a solid deforms in one step, and carries places near it along: a place keeps its offset
// from the closest triangle while that triangle moves and turns. Seen this way, the surface stands still where it ends,
// as a rigid collider does in its own frame. Not here: where the surface is at which time (shapes/solid_motion.h).
#pragma once

#include <Eigen/Geometry>
#include <memory>

#include "base/types.h"

namespace supple {

class TriangleSolid;

class SurfaceMove {
 public:
  // Both solids must have the same triangles. Places nearer to the surface than `reach` [m], or than eight times the
  // longest way of a vertex if that is more, are carried along wholly. At twice that distance and beyond, places stay
  // where they are: no part of the surface can come so far in a step.
  SurfaceMove(std::shared_ptr<const TriangleSolid> start, std::shared_ptr<const TriangleSolid> end, double reach);

  bool moves() const { return most_ > 0; }
  // Returns where a place near the surface is carried to, in the solid's frame.
  Vec3 carried(const Vec3& p) const;
  // Returns a bound above the way of any place that is carried [m].
  double most_carried() const { return most_ + 2 * turn_ * whole_; }
  // Returns the rigid motion of the triangle that is closest to a place.
  Eigen::Isometry3d motion_near(const Vec3& p) const;

 private:
  std::shared_ptr<const TriangleSolid> start_, end_;
  double most_ = 0;   // the longest way of a vertex [m]
  double turn_ = 0;   // a bound above the chord of a triangle's turn: |R - I|
  double whole_ = 0;  // the distance within which places are carried wholly [m]
};

}  // namespace supple
