// Asks a shape about many places near each other. A shape that is one closed surface from a file answers faster where
// it remembers its answer about a place nearby; for other shapes the memory makes no difference.
#pragma once

#include <optional>

#include "geometry/shapes/shape.h"
#include "geometry/solids/surface_move.h"
#include "geometry/solids/triangle_solid.h"

namespace supple {

class ShapeProbe {
 public:
  // The shape must outlive the probe.
  explicit ShapeProbe(const Shape& shape);

  double distance(const Vec3& p) const { return shape_.distance(p); }

  // `near` is the memory of one caller about this shape.
  double distance(const Vec3& p, QueryMemory& near) const;
  SurfacePoint closest(const Vec3& p, QueryMemory& near) const;

  // Returns the closest point, or nothing where it is certainly further away than `most`. Shapes other than a closed
  // surface always return it.
  std::optional<SurfacePoint> closest_within(const Vec3& p, double most, QueryMemory& near) const;

  // Returns a bound below the distance of p that follows from earlier answers; minus infinity where nothing follows.
  double certain_distance(const Vec3& p, const QueryMemory& near) const;

  // Tells whether the distance changes no faster than the point moves, and changes its sign only where it is 0. The
  // distance of one point then tells the sign at all points that are nearer to it than that.
  bool is_exact() const { return solid_ != nullptr && solid_->is_closed(); }

  // Tells whether the shape can say where a straight way enters it.
  bool knows_entries() const { return solid_ != nullptr; }
  // Returns the share of the way from a, which lies outside, to b after which the way first enters the shape; nothing
  // where it does not enter. Only for shapes that know entries.
  std::optional<double> entry(const Vec3& a, const Vec3& b) const { return solid_->entry(local(a), local(b)); }

  // These return, in the shape's frame, how the surface carries along in a step what is near it: the place to which p
  // is carried, a bound above the way of any place, and the rigid motion near p. Only for shapes that know entries.
  Vec3 carried(const Vec3& p, const SurfaceMove& move) const;
  double most_carried(const SurfaceMove& move) const { return surface_->scale * move.most_carried(); }
  Eigen::Isometry3d motion_near(const Vec3& p, const SurfaceMove& move) const;

  // Returns the solid whose answers a memory keeps; null for shapes that are not one closed surface, for which a memory
  // is of no use.
  std::shared_ptr<const TriangleSolid> remembered() const;

 private:
  Vec3 local(const Vec3& p) const { return surface_->to_local * p / surface_->scale; }
  SurfacePoint in_frame_of_shape(const Vec3& p, const SurfacePoint& found) const;

  const Shape& shape_;
  const ShapePart* surface_ = nullptr;    // the whole shape, where that is one closed surface
  const TriangleSolid* solid_ = nullptr;  // its triangles, in their own frame
};

}  // namespace supple
