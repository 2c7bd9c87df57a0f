// Gradients of a shape's field, and its closest points.
#include <algorithm>
#include <cmath>

#include "geometry/shape.h"

namespace supple {
namespace {

struct Slope {
  double distance;
  Vec3 gradient;
};

// v / |v|; where there is no direction (a sphere's centre), any will do.
Vec3 unit(const Vec3& v, const Vec3& otherwise = Vec3::UnitY()) {
  const double length = v.norm();
  return length > 1e-300 ? Vec3(v / length) : otherwise;
}

// Some direction across an axis.
Vec3 across(const Vec3& axis) {
  return unit(axis.cross(std::abs(axis.x()) < std::abs(axis.y()) ? Vec3::UnitX() : Vec3::UnitY()), Vec3::UnitX());
}

Slope slope_of(const ShapeGroup& group, const Vec3& p);

// Gradients of the primitives' distances, unit vectors. The ellipsoid's is right on its surface, which is where the
// iteration for its closest point ends.
Vec3 gradient_of(const Sphere&, const Vec3& p) { return unit(p); }
Vec3 gradient_of(const Ellipsoid& e, const Vec3& p) { return unit(p.cwiseQuotient(e.radii.cwiseProduct(e.radii))); }

Vec3 gradient_of(const Capsule& c, const Vec3& p) {
  const Vec3 axis = c.to - c.from;
  const double length2 = axis.squaredNorm();
  const double along = length2 > 0 ? std::clamp((p - c.from).dot(axis) / length2, 0.0, 1.0) : 0.0;
  return unit(p - c.from - along * axis, across(axis));
}

// The distance is the smallest |p - c(s)| - r(s) over the balls s in [0, 1] between the ends; the gradient points away
// from the ball that it belongs to.
Vec3 gradient_of(const RoundCone& c, const Vec3& p) {
  const Vec3 axis = c.to - c.from;
  const double length = axis.norm();
  const double narrowing = c.from_radius - c.to_radius;
  if (length <= std::abs(narrowing)) return unit(p - (c.from_radius > c.to_radius ? c.from : c.to));
  const Vec3 from_p = p - c.from;
  const double along = from_p.dot(axis) / length;
  const double radial = (from_p - along / length * axis).norm();
  const double lean = narrowing / length;  // sine of the cone's half angle
  const double s = std::clamp((along - radial * lean / std::sqrt(1 - lean * lean)) / length, 0.0, 1.0);
  return unit(from_p - s * axis, across(axis));
}

Vec3 gradient_of(const Box& b, const Vec3& p) {
  const Vec3 q = p.cwiseAbs() - (b.half - Vec3::Constant(b.round));
  const Vec3 side(std::copysign(1.0, p.x()), std::copysign(1.0, p.y()), std::copysign(1.0, p.z()));
  if (q.maxCoeff() > 0) return unit(q.cwiseMax(0)).cwiseProduct(side);
  Eigen::Index nearest;
  q.maxCoeff(&nearest);
  return side[nearest] * Vec3::Unit(nearest);
}

Vec3 gradient_of(const Cylinder& c, const Vec3& p) {
  const Vec3 outward = unit(Vec3(p.x(), 0, p.z()), Vec3::UnitX());
  const Vec3 up = std::copysign(1.0, p.y()) * Vec3::UnitY();
  const double radial = std::sqrt(p.x() * p.x() + p.z() * p.z()) - (c.radius - c.round);
  const double axial = std::abs(p.y()) - (c.half_height - c.round);
  if (std::max(radial, axial) > 0) return unit(std::max(radial, 0.0) * outward + std::max(axial, 0.0) * up);
  return radial > axial ? outward : up;
}

Vec3 gradient_of(const Torus& t, const Vec3& p) {
  const Vec3 outward = unit(Vec3(p.x(), 0, p.z()), Vec3::UnitX());
  return unit(p - t.radius * outward);
}

Vec3 gradient_of(const HalfSpace& h, const Vec3&) { return h.normal; }
Vec3 gradient_of(const ClosedSurface& s, const Vec3& p) { return s.solid->closest(p).normal; }
Vec3 gradient_of(const ShapeGroup& group, const Vec3& p) { return slope_of(group, p).gradient; }

Slope slope_of(const ShapePart& part, const Vec3& p) {
  if (const auto* surface = std::get_if<ClosedSurface>(&part.primitive); surface != nullptr && !part.mirror_x) {
    const SurfacePoint at = surface->solid->closest(part.to_local * p / part.scale);  // one question for both
    return {part.scale * at.distance, part.to_local.linear().transpose() * at.normal};
  }
  const auto local = [&part](const Vec3& point) { return Vec3(part.to_local * point / part.scale); };
  const auto mirrored = [](const Vec3& v) { return Vec3(-v.x(), v.y(), v.z()); };
  Vec3 here = local(p);
  double field = part.scale * distance(part.primitive, here);
  bool other = false;
  if (part.mirror_x) {
    const Vec3 there = local(mirrored(p));
    const double there_field = part.scale * distance(part.primitive, there);
    if (there_field < field) {
      field = there_field;
      here = there;
      other = true;
    }
  }
  const Vec3 gradient = part.to_local.linear().transpose() *
                        std::visit([&here](const auto& shape) { return gradient_of(shape, here); }, part.primitive);
  return {field, other ? mirrored(gradient) : gradient};
}

Slope slope_of(const ShapeGroup& group, const Vec3& p) {
  if (group.parts.empty()) return {1e9, Vec3::UnitY()};
  Slope slope = slope_of(group.parts.front(), p);
  for (std::size_t i = 1; i < group.parts.size(); ++i) {
    const ShapePart& how = group.parts[i];
    const Slope part = slope_of(how, p);
    const double field_sign = how.combine == Combine::add ? 1 : -1;       // of the field so far in the minimum
    const double part_sign = how.combine == Combine::intersect ? -1 : 1;  // of the part
    const Melted melted = smooth_min(field_sign * slope.distance, part_sign * part.distance, how.blend);
    slope.distance = field_sign * melted.value;
    slope.gradient = (1 - melted.share) * slope.gradient + field_sign * part_sign * melted.share * part.gradient;
  }
  return slope;
}

// Whether |field| is the distance to the surface everywhere: one primitive, and not an ellipsoid.
bool exact(const ShapeGroup& group) {
  if (group.parts.size() != 1 || group.parts.front().mirror_x) return false;
  const ShapePart& part = group.parts.front();
  if (const auto* inner = std::get_if<ShapeGroup>(&part.primitive)) return exact(*inner);
  return !std::holds_alternative<Ellipsoid>(part.primitive);
}

double certainty_of(const ShapeGroup& group) {
  const bool blended =
      std::any_of(group.parts.begin(), group.parts.end(), [](const ShapePart& part) { return part.blend > 0; });
  double least = 1;
  for (const ShapePart& part : group.parts) {
    // Between (k0 - 1) r_min and (k0 - 1) r_max, with k0 as in the ellipsoid's distance. In a blend what counts is how
    // fast the field changes, which is up to (r_max / r_min)^2.
    if (const auto* e = std::get_if<Ellipsoid>(&part.primitive)) {
      const double ratio = e->radii.minCoeff() / e->radii.maxCoeff();
      least = std::min(least, blended ? ratio * ratio : ratio);
    }
    if (const auto* inner = std::get_if<ShapeGroup>(&part.primitive)) least = std::min(least, certainty_of(*inner));
  }
  return least;
}

// Half the thickness of a solid at its thinnest, 0 where that is not known.
double half_thickness(const Primitive& primitive);

double thinnest_of(const ShapeGroup& group) {
  double least = 1e300;
  for (const ShapePart& part : group.parts) {
    if (part.combine != Combine::add) return 0;
    least = std::min(least, part.scale * half_thickness(part.primitive));
  }
  return least;
}

double half_thickness(const Primitive& primitive) {
  struct Visitor {
    double operator()(const Sphere& s) const { return s.radius; }
    double operator()(const Ellipsoid& e) const { return e.radii.minCoeff(); }
    double operator()(const Capsule& c) const { return c.radius; }
    double operator()(const RoundCone& c) const { return std::min(c.from_radius, c.to_radius); }
    double operator()(const Box& b) const { return b.half.minCoeff(); }
    double operator()(const Cylinder& c) const { return std::min(c.radius, c.half_height); }
    double operator()(const Torus& t) const { return t.tube; }
    double operator()(const HalfSpace&) const { return 1e300; }
    double operator()(const ClosedSurface&) const { return 0; }
    double operator()(const ShapeGroup& g) const { return thinnest_of(g); }
  };
  return std::visit(Visitor{}, primitive);
}

}  // namespace

double Shape::half_thickness() const { return thinnest_of(root); }
double Shape::certainty() const { return certainty_of(root); }

SurfacePoint Shape::closest(const Vec3& point) const {
  Slope slope = slope_of(root, point);
  Vec3 normal = unit(slope.gradient);
  if (exact(root)) return {point - slope.distance * normal, normal, slope.distance};
  const double sign = slope.distance < 0 ? -1 : 1;
  constexpr int most_steps = 12;
  Vec3 t = point;
  double last_side = 1e300;
  for (int step = 0; step < most_steps; ++step) {
    // Newton's step to the zero set; then along the tangent plane until the normal leads to the point.
    t -= slope.distance / std::max(slope.gradient.squaredNorm(), 0.01) * slope.gradient;
    slope = slope_of(root, t);
    normal = unit(slope.gradient);
    const Vec3 back = point - t;
    const Vec3 side = back - back.dot(normal) * normal;
    const double off = side.norm() + std::abs(slope.distance);
    if (off <= 1e-9 * back.norm() || off <= 1e-12 || side.norm() >= last_side || step + 1 == most_steps) break;
    last_side = side.norm();
    t += side;
    slope = slope_of(root, t);
  }
  for (int step = 0; step < 3; ++step) {
    t -= slope.distance / std::max(slope.gradient.squaredNorm(), 0.01) * slope.gradient;
    slope = slope_of(root, t);
  }
  return {t, unit(slope.gradient), sign * (point - t).norm()};
}

}  // namespace supple
