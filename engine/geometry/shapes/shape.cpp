#include "geometry/shapes/shape.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/solids/triangle_solid.h"

namespace supple {
namespace {

constexpr double far_away = 1e9;

// std::hypot guards against an overflow that cannot happen here, and takes several times as long.
double length(double x, double y) { return std::sqrt(x * x + y * y); }

// The primitives' distances follow Quilez, "Distance functions" (iquilezles.org/articles/distfunctions).
double primitive_distance(const Sphere& s, const Vec3& p) { return p.norm() - s.radius; }

// Computes the first-order distance k0 (k0 - 1) / k1: its sign is exact; its value is accurate near the surface and
// slightly too small elsewhere.
double primitive_distance(const Ellipsoid& e, const Vec3& p) {
  const double k0 = p.cwiseQuotient(e.radii).norm();
  const double k1 = p.cwiseQuotient(e.radii.cwiseProduct(e.radii)).norm();
  if (k1 < 1e-300) return -e.radii.minCoeff();
  const double first_order = k0 * (k0 - 1) / k1;
  return k0 < 1 ? std::max(first_order, (k0 - 1) * e.radii.minCoeff())
                : first_order;  // never deeper than the thinnest axis allows
}

double primitive_distance(const Capsule& c, const Vec3& p) {
  const Vec3 axis = c.to - c.from;
  const double length2 = axis.squaredNorm();
  const double along = length2 > 0 ? std::clamp((p - c.from).dot(axis) / length2, 0.0, 1.0) : 0.0;
  return (p - c.from - along * axis).norm() - c.radius;
}

double primitive_distance(const RoundCone& c, const Vec3& p) {
  const Vec3 axis = c.to - c.from;
  const double length2 = axis.squaredNorm();
  const double narrowing = c.from_radius - c.to_radius;
  const double slant2 = length2 - narrowing * narrowing;
  if (slant2 <= 0) {  // one ball holds the other
    return c.from_radius > c.to_radius ? (p - c.from).norm() - c.from_radius : (p - c.to).norm() - c.to_radius;
  }
  const Vec3 from_p = p - c.from;
  const double y = from_p.dot(axis);
  const double z = y - length2;
  const double x2 = (from_p * length2 - axis * y).squaredNorm();
  const double y2 = y * y * length2;
  const double z2 = z * z * length2;
  const double k = std::copysign(narrowing * narrowing * x2, narrowing);
  if (std::copysign(slant2 * z2, z) > k) return std::sqrt(x2 + z2) / length2 - c.to_radius;
  if (std::copysign(slant2 * y2, y) < k) return std::sqrt(x2 + y2) / length2 - c.from_radius;
  return (std::sqrt(x2 * slant2 / length2) + y * narrowing) / length2 - c.from_radius;
}

double primitive_distance(const Box& b, const Vec3& p) {
  const Vec3 q = p.cwiseAbs() - (b.half - Vec3::Constant(b.round));
  return q.cwiseMax(0).norm() + std::min(q.maxCoeff(), 0.0) - b.round;
}

double primitive_distance(const Cylinder& c, const Vec3& p) {
  const double radial = length(p.x(), p.z()) - (c.radius - c.round);
  const double axial = std::abs(p.y()) - (c.half_height - c.round);
  return length(std::max(radial, 0.0), std::max(axial, 0.0)) + std::min(std::max(radial, axial), 0.0) - c.round;
}

double primitive_distance(const Torus& t, const Vec3& p) {
  return length(length(p.x(), p.z()) - t.radius, p.y()) - t.tube;
}

double primitive_distance(const HalfSpace& h, const Vec3& p) { return h.normal.dot(p) - h.offset; }

double primitive_distance(const ClosedSurface& s, const Vec3& p) { return s.solid->closest(p).distance; }

double primitive_distance(const ShapeGroup& group, const Vec3& p) { return distance(group, p); }

double combined(double field, double part, const ShapePart& how) {
  switch (how.combine) {
    case Combine::add: return smooth_min(field, part, how.blend).value;
    case Combine::cut: return -smooth_min(-field, part, how.blend).value;
    case Combine::intersect: return -smooth_min(-field, -part, how.blend).value;
  }
  return field;
}

Bounds box_around(const Vec3& center, const Vec3& half) {
  Bounds box;
  box.include(center - half);
  box.include(center + half);
  return box;
}

Bounds merged(Bounds a, const Bounds& b) {
  if (b.empty()) return a;
  a.include(b.lower);
  a.include(b.upper);
  return a;
}

Bounds bounds_of_group(const ShapeGroup& group);

Bounds primitive_bounds(const Primitive& primitive) {
  struct Visitor {
    Bounds operator()(const Sphere& s) const { return box_around(Vec3::Zero(), Vec3::Constant(s.radius)); }
    Bounds operator()(const Ellipsoid& e) const { return box_around(Vec3::Zero(), e.radii); }
    Bounds operator()(const Capsule& c) const {
      return merged(box_around(c.from, Vec3::Constant(c.radius)), box_around(c.to, Vec3::Constant(c.radius)));
    }
    Bounds operator()(const RoundCone& c) const {
      return merged(box_around(c.from, Vec3::Constant(c.from_radius)), box_around(c.to, Vec3::Constant(c.to_radius)));
    }
    Bounds operator()(const Box& b) const { return box_around(Vec3::Zero(), b.half); }
    Bounds operator()(const Cylinder& c) const {
      return box_around(Vec3::Zero(), Vec3(c.radius, c.half_height, c.radius));
    }
    Bounds operator()(const Torus& t) const {
      return box_around(Vec3::Zero(), Vec3(t.radius + t.tube, t.tube, t.radius + t.tube));
    }
    Bounds operator()(const HalfSpace&) const { return box_around(Vec3::Zero(), Vec3::Constant(far_away)); }
    Bounds operator()(const ClosedSurface& s) const { return s.solid->bounds(); }
    Bounds operator()(const ShapeGroup& g) const { return bounds_of_group(g); }
  };
  return std::visit(Visitor{}, primitive);
}

Bounds part_bounds(const ShapePart& part) {
  const Bounds local = primitive_bounds(part.primitive);
  if (local.empty()) return local;
  const Eigen::Isometry3d to_parent = part.to_local.inverse();
  Bounds box;
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 p((corner & 1 ? local.upper : local.lower).x(), (corner & 2 ? local.upper : local.lower).y(),
                 (corner & 4 ? local.upper : local.lower).z());
    const Vec3 q = to_parent * Vec3(part.scale * p);
    box.include(q);
    if (part.mirror_x) box.include(Vec3(-q.x(), q.y(), q.z()));
  }
  return box;
}

Bounds bounds_of_group(const ShapeGroup& group) {
  Bounds box;
  for (const ShapePart& part : group.parts) {
    if (part.combine == Combine::cut) continue;
    const Bounds other = part_bounds(part);
    if (part.combine == Combine::intersect) {
      box.lower = box.lower.cwiseMax(other.lower);
      box.upper = box.upper.cwiseMin(other.upper);
    } else {
      box = merged(box, other);
      if (part.blend > 0 && !box.empty()) {
        box.lower.array() -= 0.25 * part.blend;
        box.upper.array() += 0.25 * part.blend;
      }
    }
  }
  return box;
}

struct NearestRegion {
  double distance = std::numeric_limits<double>::infinity();
  int region = 0;
  int containing = 0;  // the last tagged part that holds the point
};

void find_region(const ShapeGroup& group, const Vec3& point, int inherited, NearestRegion& nearest) {
  for (const ShapePart& part : group.parts) {
    if (part.combine != Combine::add) continue;
    const int region = part.region != 0 ? part.region : inherited;
    const double d = part.distance(point);
    if (d <= 0 && region != 0) nearest.containing = region;
    if (d < nearest.distance) {
      nearest.distance = d;
      nearest.region = region;
    }
    if (const auto* inner = std::get_if<ShapeGroup>(&part.primitive)) {
      Vec3 q = point;
      if (part.mirror_x) q.x() = std::abs(q.x());
      find_region(*inner, part.to_local * q / part.scale, region, nearest);
    }
  }
}

}  // namespace

Blended smooth_min(double a, double b, double blend) {
  if (blend <= 0) return {std::min(a, b), b < a ? 1.0 : 0.0};
  const double h = std::max(blend - std::abs(a - b), 0.0) / blend;
  return {std::min(a, b) - 0.25 * blend * h * h, b < a ? 1 - 0.5 * h : 0.5 * h};
}

double distance(const Primitive& primitive, const Vec3& point) {
  return std::visit([&point](const auto& shape) { return primitive_distance(shape, point); }, primitive);
}

double ShapePart::distance(const Vec3& point) const {
  const auto local = [this](const Vec3& p) { return scale * supple::distance(primitive, to_local * p / scale); };
  const double here = local(point);
  return mirror_x ? std::min(here, local(Vec3(-point.x(), point.y(), point.z()))) : here;
}

double distance(const ShapeGroup& group, const Vec3& point) {
  double field = far_away;
  for (const ShapePart& part : group.parts) field = combined(field, part.distance(point), part);
  return field;
}

double Shape::distance(const Vec3& point) const { return supple::distance(root, point); }

Vec3 Shape::gradient(const Vec3& point, double step) const {
  Vec3 slope;
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 forward = point, backward = point;
    forward[axis] += step;
    backward[axis] -= step;
    slope[axis] = (distance(forward) - distance(backward)) / (2 * step);
  }
  return slope;
}

Bounds Shape::bounds() const { return bounds_of_group(root); }

int Shape::region(const Vec3& point) const {
  NearestRegion nearest;
  find_region(root, point, 0, nearest);
  if (nearest.containing != 0) return nearest.containing;
  return nearest.distance > 0 ? nearest.region : 0;
}

Shape shape_of(TriMesh closed_surface) {
  Shape shape;
  ShapePart part;
  part.primitive = ClosedSurface{std::make_shared<TriangleSolid>(std::move(closed_surface))};
  shape.root.parts.push_back(std::move(part));
  return shape;
}

}  // namespace supple
