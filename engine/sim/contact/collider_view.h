// Shows one collider over one step from its own frame of reference, where it stands still: the paths of points of the
// world through that frame, and the surfaces that they meet. A collider that turns far in a step bends these ways into
// arcs; between the two poses of a step it moves evenly. One that deforms has the shape in which the step ends, and
// what is near its surface at the start is carried along to there (geometry/solids/surface_move.h). Not here: which
// vertices are looked at (find_contacts.h).
#pragma once

#include <optional>

#include "geometry/shapes/shape_probe.h"
#include "sim/model/inputs.h"

namespace supple {

// Holds the traits of a shape, for which a search asks once.
struct ColliderTraits {
  double certainty;             // Shape::certainty
  double half_thickness;        // Shape::half_thickness [m]
  double usual_half_thickness;  // Shape::usual_half_thickness [m]
};

// Describes the way of a point of the world through the collider's frame, from q when the step starts to x when it
// ends.
struct Way {
  Vec3 q, x;      // in the world [m]
  Vec3 a, b;      // its ends in the collider's frame [m]
  double length;  // the way's length, or a bound above it [m]
};

class ColliderView {
 public:
  ColliderView(const Collider& collider, const ColliderMotion& motion, const ColliderTraits& traits);

  const Eigen::Isometry3d& start() const { return start_; }
  const Eigen::Isometry3d& end() const { return end_; }
  Vec3 at_start(const Vec3& world) const {
    const Vec3 own = to_start_ * world;
    return surface_ == nullptr ? own : shape_.carried(own, *surface_);
  }
  Vec3 at_end(const Vec3& world) const { return to_end_ * world; }
  // Returns where a place ends the step if the collider carries it along from the start.
  Vec3 carried(const Vec3& world) const { return end_ * at_start(world); }
  Way way(const Vec3& q, const Vec3& x) const { return way_from(at_start(q), q, x); }
  // Returns the way of a point for which at_start(q) is known.
  Way way_from(const Vec3& a, const Vec3& q, const Vec3& x) const {
    Way way{q, x, a, to_end_ * x, 0};
    way.length = bends_ ? bent_length(q, x) : (way.b - way.a).norm();
    return way;
  }
  // Returns the length that a way would have if it ended at x.
  double length_to(const Vec3& x, const Way& way) const {
    return bends_ ? bent_length(way.q, x) : (to_end_ * x - way.a).norm();
  }

  // Returns where a way is after a share of the step.
  Vec3 at(const Way& way, double share) const;
  // Returns the velocity of a point on its way after a share of the step, in metres a step.
  Vec3 pace(const Way& way, double share) const;
  // Returns the motion of the collider in the rest of the step, without what deforms it.
  Eigen::Isometry3d motion_after(double share) const;
  // Returns the motion in the rest of the step of that part of the surface which is closest to a place of the world at
  // the start of the step.
  Eigen::Isometry3d motion_near(const Vec3& place, double share) const;
  bool moves() const { return moves_; }
  bool deforms() const { return surface_ != nullptr; }

  // Returns the distance to the layer around the shape. `near` is the memory of a caller that asks about places near
  // each other.
  double distance(const Vec3& p, QueryMemory& near) const { return shape_.distance(p, near) - collider_.thickness; }
  // Returns the closest point of that layer's surface.
  SurfacePoint closest(const Vec3& p, QueryMemory& near) const;
  // Tells whether closest_within() may serve to decide that the surface is further away than a bound: it is cheaper
  // than closest(), and when it finds nothing, the sign of the distance is the same within the bound. Surfaces with
  // holes do not have this: the sign changes there without a triangle nearby.
  bool knows_bounds() const { return shape_.is_exact(); }
  // Returns what closest() returns, but nothing where the surface is certainly further away than `most`, outside or
  // inside.
  std::optional<SurfacePoint> closest_within(const Vec3& p, double most, QueryMemory& near) const;

  // Returns a lower bound of the distance of p to the layer, as it follows from earlier answers; minus infinity where
  // nothing follows.
  double certain_distance(const Vec3& p, const QueryMemory& near) const {
    return shape_.certain_distance(p, near) - collider_.thickness;
  }

  // Returns how far the collider's own points within a ball move in the step at most: they move with the ball's centre
  // and turn about it.
  double most_moved(const Vec3& center, double radius) const;
  // Returns a lower bound of the distances that the points within a ball have at the start.
  double least_distance(const Vec3& center, double radius, QueryMemory& near) const;
  // Returns by how much the distance may change along a way of this length.
  double uncertain(double length) const { return length / traits_.certainty; }
  // Returns how far a point at this distance from the layer can certainly go without meeting it.
  double clear(double distance) const {
    return std::max(0.0, traits_.certainty * (distance + collider_.thickness) - collider_.thickness);
  }

  // Describes the surface through which a point enters or, if the point starts inside, the one that is closest to it
  // then.
  struct Entry {
    SurfacePoint surface;
    double way;  // share of the step, 0 to 1
  };
  // Finds where a way enters; nothing when it stays outside, or enters only after the share `latest` of the step.
  std::optional<Entry> entry(const Way& way, double field_at_a, QueryMemory& near, double latest = 1) const;

  // Finds the surface that holds a vertex at the end of its way: the closest one or, where the vertex came in by
  // another side, usually that side. Nothing when there is none within `reach`. What goes around the rim of a plate of
  // triangles, through no more than the layer, is held by the closest side.
  std::optional<SurfacePoint> holding(const Way& way, double field_at_a, double reach, QueryMemory& near) const;

 private:
  double bent_length(const Vec3& q, const Vec3& x) const;
  SurfacePoint on_layer(SurfacePoint s) const;
  bool leads_through(const Way& way, double field_at_a, double field_at_b) const;
  // Tells whether a way is too short to lead through the shape.
  bool short_way(double way) const { return way < traits_.half_thickness; }
  std::optional<double> meets(const Way& way, double from, double to, double field_at_start, QueryMemory& near,
                              double latest = 1) const;
  Eigen::Isometry3d pose(double share) const;

  const Collider& collider_;
  ShapeProbe shape_;
  Eigen::Isometry3d start_, end_, to_start_, to_end_;
  ColliderTraits traits_;
  const SurfaceMove* surface_ = nullptr;  // null: the collider does not deform in the step
  bool moves_ = false;
  bool bends_ = false;  // whether the collider turns so far that ways are arcs
  // These hold the collider's turn in a step, where it bends ways: as a vector along the world's axes, and as an axis
  // and an angle [rad].
  Vec3 turn_ = Vec3::Zero(), axis_ = Vec3::Zero();
  double angle_ = 0;
};

}  // namespace supple
