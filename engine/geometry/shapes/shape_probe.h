// Asks a shape about many places near each other. A shape that is one closed surface from a file answers faster when it
// knows what it has answered to a place nearby; other shapes answer as they always do.
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

  // Tells whether the distance changes no faster than the point moves, and its sign where it is 0 alone: from one value
  // then follow the signs around.
  bool is_exact() const { return solid_ != nullptr && solid_->is_closed(); }

  // Tells whether the shape can say where a straight way enters it.
  bool knows_entries() const { return solid_ != nullptr; }
  // Returns which share of the way from a, which lies outside, to b leads to where it first enters; nothing when it
  // does not. Only for shapes that know entries.
  std::optional<double> entry(const Vec3& a, const Vec3& b) const { return solid_->entry(local(a), local(b)); }

  // These tell how the surface carries what is near it along in a step, in the shape's frame: a place, a bound above
  // the way of any place, and the rigid motion near a place. Only for shapes that know entries.
  Vec3 carried(const Vec3& p, const SurfaceMove& move) const;
  double most_carried(const SurfaceMove& move) const { return surface_->scale * move.most_carried(); }
  Eigen::Isometry3d motion_near(const Vec3& p, const SurfaceMove& move) const;

  // Returns the solid whose answers a memory keeps; null for other shapes, which have no use for one.
  std::shared_ptr<const TriangleSolid> remembered() const;

 private:
  Vec3 local(const Vec3& p) const { return surface_->to_local * p / surface_->scale; }
  SurfacePoint in_frame_of_shape(const Vec3& p, const SurfacePoint& found) const;

  const Shape& shape_;
  const ShapePart* surface_ = nullptr;    // the whole shape, where that is one closed surface
  const TriangleSolid* solid_ = nullptr;  // its triangles, in their own frame
};

}  // namespace supple
