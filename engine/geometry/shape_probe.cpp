#include "geometry/shape_probe.h"

namespace supple {
namespace {

// The part that is a whole shape, where that is one closed surface; null otherwise.
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

double ShapeProbe::distance(const Vec3& p, std::int32_t& near) const {
  if (solid_ == nullptr) return shape_.distance(p);
  return surface_->scale * solid_->closest(local(p), near).distance;
}

double ShapeProbe::distance_within(const Vec3& p, double most) const {
  if (solid_ == nullptr) return shape_.distance(p);
  return surface_->scale * solid_->distance_within(local(p), most / surface_->scale);
}

SurfacePoint ShapeProbe::closest(const Vec3& p, std::int32_t& near) const {
  if (solid_ == nullptr) return shape_.closest(p);
  const Mat3 turn = surface_->to_local.linear().transpose();
  const Vec3 at = local(p);
  const SurfacePoint found = solid_->closest(at, near);
  return {p - surface_->scale * (turn * (at - found.point)), turn * found.normal, surface_->scale * found.distance};
}

}  // namespace supple
