#include "geometry/shapes/shape_probe.h"

#include <limits>

namespace supple {
namespace {

// Returns the part that is the whole shape, where it is one closed surface; null otherwise.
const ShapePart* lone_surface(const Shape& shape) {
  if (shape.root.parts.size() != 1) return nullptr;
  const ShapePart& part = shape.root.parts.front();
  const bool whole = !part.mirror_x && part.combine == Combine::add;
  return whole && std::holds_alternative<ClosedSurface>(part.primitive) ? &part : nullptr;
}

}  // namespace

ShapeProbe::ShapeProbe(const Shape& shape) : shape_(shape), surface_(lone_surface(shape)) {
  if (surface_ != nullptr) solid_ = std::get<ClosedSurface>(surface_->primitive).solid.get();
}

double ShapeProbe::distance(const Vec3& p, QueryMemory& near) const {
  if (solid_ == nullptr) return shape_.distance(p);
  return surface_->scale * solid_->closest(local(p), near).distance;
}

double ShapeProbe::certain_distance(const Vec3& p, const QueryMemory& near) const {
  if (solid_ == nullptr) return -std::numeric_limits<double>::infinity();
  return surface_->scale * solid_->certain_distance(local(p), near);
}

std::shared_ptr<const TriangleSolid> ShapeProbe::remembered() const {
  return surface_ == nullptr ? nullptr : std::get<ClosedSurface>(surface_->primitive).solid;
}

SurfacePoint ShapeProbe::closest(const Vec3& p, QueryMemory& near) const {
  return solid_ == nullptr ? shape_.closest(p) : in_frame_of_shape(p, solid_->closest(local(p), near));
}

std::optional<SurfacePoint> ShapeProbe::closest_within(const Vec3& p, double most, QueryMemory& near) const {
  if (solid_ == nullptr) return shape_.closest(p);
  const std::optional<SurfacePoint> found = solid_->closest_within(local(p), most / surface_->scale, near);
  return found ? std::optional(in_frame_of_shape(p, *found)) : std::nullopt;
}

Vec3 ShapeProbe::carried(const Vec3& p, const SurfaceMove& move) const {
  const Vec3 from = local(p), to = move.carried(from);
  return p + surface_->scale * (surface_->to_local.linear().transpose() * (to - from));
}

Eigen::Isometry3d ShapeProbe::motion_near(const Vec3& p, const SurfaceMove& move) const {
  Eigen::Isometry3d own = move.motion_near(local(p));
  own.translation() *= surface_->scale;
  return surface_->to_local.inverse() * own * surface_->to_local;
}

SurfacePoint ShapeProbe::in_frame_of_shape(const Vec3& p, const SurfacePoint& found) const {
  const Mat3 turn = surface_->to_local.linear().transpose();
  return {p - surface_->scale * (turn * (local(p) - found.point)), turn * found.normal,
          surface_->scale * found.distance};
}

}  // namespace supple
