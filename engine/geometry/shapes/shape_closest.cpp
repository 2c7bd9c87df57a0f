// Computes gradients of a shape's field, and its closest points.
#include <algorithm>
#include <cmath>
#include <optional>

#include "geometry/shapes/shape.h"
#include "geometry/solids/triangle_solid.h"

namespace supple {
namespace {

struct Slope {
  double distance;
  Vec3 gradient;
};

// Returns v / |v|, or the second argument where v has no direction (at a sphere's centre any one will do).
Vec3 unit(const Vec3& v, const Vec3& otherwise = Vec3::UnitY()) {
  const double length = v.norm();
  return length > 1e-300 ? Vec3(v / length) : otherwise;
}

// Returns some direction at right angles to an axis.
Vec3 across(const Vec3& axis) {
  return unit(axis.cross(std::abs(axis.x()) < std::abs(axis.y()) ? Vec3::UnitX() : Vec3::UnitY()), Vec3::UnitX());
}

// Returns the direction from an axis through the origin to p, and any direction at right angles to the axis where p
// lies on it up to round-off.
Vec3 off_axis(const Vec3& p, const Vec3& axis) {
  const Vec3 along = unit(axis);
  const Vec3 radial = p - p.dot(along) * along;
  return radial.norm() > 1e-14 * p.norm() ? unit(radial - radial.dot(along) * along, across(axis)) : across(axis);
}

Slope slope_of(const ShapeGroup& group, const Vec3& p);

// These are the gradients of the primitives' distances: unit vectors, except that the ellipsoid's has unit length only
// on its surface.
Vec3 gradient_of(const Sphere&, const Vec3& p) { return unit(p); }

Vec3 gradient_of(const Ellipsoid& e, const Vec3& p) {
  const Vec3 squares = e.radii.cwiseProduct(e.radii);
  const double k0 = p.cwiseQuotient(e.radii).norm(), k1 = p.cwiseQuotient(squares).norm();
  Eigen::Index thin;
  const double thinnest = e.radii.minCoeff(&thin);
  if (k1 < 1e-300) return Vec3::Unit(thin);
  const Vec3 of_k0 = p.cwiseQuotient(squares) / k0;
  if (k0 < 1 && k0 * thinnest < k1) return thinnest * of_k0;  // here the thinnest axis limits the distance
  const Vec3 of_k1 = p.cwiseQuotient(squares.cwiseProduct(squares)) / k1;
  return ((2 * k0 - 1) * of_k0 - k0 * (k0 - 1) / k1 * of_k1) / k1;
}

Vec3 gradient_of(const Capsule& c, const Vec3& p) {
  const Vec3 axis = c.to - c.from;
  const double along = (p - c.from).dot(axis);
  if (along <= 0) return unit(p - c.from, across(axis));
  if (along > axis.squaredNorm()) return unit(p - c.to);
  return off_axis(p - c.from, axis);
}

// The distance is the smallest |p - c(s)| - r(s) over the balls s in [0, 1] between the ends; the gradient points away
// from the ball that gives the minimum.
Vec3 gradient_of(const RoundCone& c, const Vec3& p) {
  const Vec3 axis = c.to - c.from;
  const double length = axis.norm();
  const double narrowing = c.from_radius - c.to_radius;
  if (length <= std::abs(narrowing)) return unit(p - (c.from_radius > c.to_radius ? c.from : c.to));
  const Vec3 from_p = p - c.from;
  const double along = from_p.dot(axis) / length;
  const double radial = (from_p - along / length * axis).norm();
  const double lean = narrowing / length;  // sine of the cone's half angle
  const double flat = std::sqrt(1 - lean * lean);
  const double s = (along - radial * lean / flat) / length;
  if (s < 0) return unit(from_p);
  if (s > 1) return unit(p - c.to);
  return unit(flat * off_axis(from_p, axis) + lean / length * axis);
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
  const double radial = std::sqrt(p.x() * p.x() + p.z() * p.z()) - t.radius;
  return unit(radial * outward + p.y() * Vec3::UnitY());
}

Vec3 gradient_of(const HalfSpace& h, const Vec3&) { return h.normal; }
Vec3 gradient_of(const ClosedSurface& s, const Vec3& p) { return s.solid->closest(p).normal; }
Vec3 gradient_of(const ShapeGroup& group, const Vec3& p) { return slope_of(group, p).gradient; }

Slope slope_of(const ShapePart& part, const Vec3& p) {
  if (const auto* surface = std::get_if<ClosedSurface>(&part.primitive); surface != nullptr && !part.mirror_x) {
    const SurfacePoint at = surface->solid->closest(part.to_local * p / part.scale);  // one query gives both
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
  Slope slope = {1e9, Vec3::UnitY()};  // the field of an empty group, as in distance()
  for (const ShapePart& how : group.parts) {
    const Slope part = slope_of(how, p);
    const double field_sign = how.combine == Combine::add ? 1 : -1;       // sign of the field so far in the minimum
    const double part_sign = how.combine == Combine::intersect ? -1 : 1;  // sign of the part's field
    const Blended blended = smooth_min(field_sign * slope.distance, part_sign * part.distance, how.blend);
    slope.distance = field_sign * blended.value;
    slope.gradient = (1 - blended.share) * slope.gradient + field_sign * part_sign * blended.share * part.gradient;
  }
  return slope;
}

// The method is that of Eberly, "Distance from a Point to an Ellipse, an Ellipsoid, or a Hyperellipsoid" (2013): the
// closest point is r_i^2 p_i / (r_i^2 - r_min^2 + s), where s > 0 puts it on the surface. Newton's method on 1 / |q|
// finds s from below without stepping over it.
SurfacePoint closest_of(const Ellipsoid& e, const Vec3& p) {
  const Vec3 squares = e.radii.cwiseProduct(e.radii);
  const Vec3 y = (p.array().abs() < 1e-150).select(0, p.array().abs());  // so that products with y don't vanish
  Eigen::Index thin;
  const Vec3 above = squares.array() - squares.minCoeff(&thin);  // r_i^2 - r_min^2
  double s = (e.radii.cwiseProduct(y) - above).maxCoeff();       // puts one coordinate alone on the surface
  Vec3 q = Vec3::Zero();                                         // the closest point divided by the radii
  constexpr int most_steps = 50;
  for (int step = 0; step < most_steps; ++step) {
    double slope = 0;
    for (int i = 0; i < 3; ++i) {
      q[i] = y[i] > 0 ? e.radii[i] * y[i] / (above[i] + s) : 0.0;
      if (y[i] > 0) slope += q[i] * q[i] / (above[i] + s);
    }
    const double size = q.norm();
    if (size <= 1 || slope <= 0) break;
    const double next = s + size * size / slope * (size - 1);
    if (next <= s) break;
    s = next;
  }
  // Here p lies in the middle plane of the thinnest axis, so deep that the other two coordinates stay inside: the
  // surface is as near above as below.
  if (y[thin] <= 0 && q.squaredNorm() < 1) q[thin] = std::sqrt(1 - q.squaredNorm());
  q = unit(q);
  Vec3 point, normal;
  for (int i = 0; i < 3; ++i) {
    point[i] = std::copysign(e.radii[i] * q[i], p[i]);
    normal[i] = std::copysign(q[i] / e.radii[i], p[i]);
  }
  const double sign = p.cwiseQuotient(e.radii).norm() < 1 ? -1 : 1;
  return {point, unit(normal), sign * (p - point).norm()};
}

template <class Kind>
SurfacePoint closest_of(const Kind& primitive, const Vec3& p) {
  const double field = distance(primitive, p);
  const Vec3 normal = gradient_of(primitive, p);
  return {p - field * normal, normal, field};
}
SurfacePoint closest_of(const ClosedSurface& s, const Vec3& p) { return s.solid->closest(p); }

// Returns the exact closest point of a shape that is a single primitive; nothing for other shapes.
std::optional<SurfacePoint> closest_of_one(const ShapeGroup& group, const Vec3& p) {
  if (group.parts.size() != 1) return std::nullopt;
  const ShapePart& part = group.parts.front();
  if (part.mirror_x || part.combine != Combine::add) return std::nullopt;
  const Vec3 local = part.to_local * p / part.scale;
  std::optional<SurfacePoint> found;
  if (const auto* inner = std::get_if<ShapeGroup>(&part.primitive)) {
    found = closest_of_one(*inner, local);
  } else {
    found = std::visit([&local](const auto& shape) { return closest_of(shape, local); }, part.primitive);
  }
  if (!found) return std::nullopt;
  const Vec3 normal = part.to_local.linear().transpose() * found->normal;
  return SurfacePoint{p - part.scale * (part.to_local.linear().transpose() * (local - found->point)), normal,
                      part.scale * found->distance};
}

double certainty_of(const ShapeGroup& group) {
  const bool blended =
      std::any_of(group.parts.begin(), group.parts.end(), [](const ShapePart& part) { return part.blend > 0; });
  double least = 1;
  for (const ShapePart& part : group.parts) {
    // The distance lies between (k0 - 1) r_min and (k0 - 1) r_max, with k0 as in the ellipsoid's distance. In a blend,
    // what counts is how fast the field changes, which is up to (r_max / r_min)^2.
    if (const auto* e = std::get_if<Ellipsoid>(&part.primitive)) {
      const double ratio = e->radii.minCoeff() / e->radii.maxCoeff();
      least = std::min(least, blended ? ratio * ratio : ratio);
    }
    if (const auto* inner = std::get_if<ShapeGroup>(&part.primitive)) least = std::min(least, certainty_of(*inner));
  }
  return least;
}

// Return half the thickness of a solid at its thinnest place, or 0 where it is not known. of_surface: returns that of a
// closed surface.
template <class OfSurface>
double half_thickness(const Primitive& primitive, const OfSurface& of_surface);

template <class OfSurface>
double thinnest_of(const ShapeGroup& group, const OfSurface& of_surface) {
  double least = 1e300;
  for (const ShapePart& part : group.parts) {
    if (part.combine != Combine::add) return 0;
    least = std::min(least, part.scale * half_thickness(part.primitive, of_surface));
  }
  return least;
}

template <class OfSurface>
double half_thickness(const Primitive& primitive, const OfSurface& of_surface) {
  struct Visitor {
    const OfSurface& of_surface;
    double operator()(const Sphere& s) const { return s.radius; }
    double operator()(const Ellipsoid& e) const { return e.radii.minCoeff(); }
    double operator()(const Capsule& c) const { return c.radius; }
    double operator()(const RoundCone& c) const { return std::min(c.from_radius, c.to_radius); }
    double operator()(const Box& b) const { return b.half.minCoeff(); }
    double operator()(const Cylinder& c) const { return std::min(c.radius, c.half_height); }
    double operator()(const Torus& t) const { return t.tube; }
    double operator()(const HalfSpace&) const { return 1e300; }
    double operator()(const ClosedSurface& s) const { return of_surface(s); }
    double operator()(const ShapeGroup& g) const { return thinnest_of(g, of_surface); }
  };
  return std::visit(Visitor{of_surface}, primitive);
}

// Follows Newton's steps to the zero set and returns whether they reached it.
bool move_to_zero_set(const ShapeGroup& root, Vec3& t, Slope& slope) {
  constexpr int most_steps = 50;
  for (int step = 0; step < most_steps; ++step) {
    if (std::abs(slope.distance) <= 1e-15 * t.norm()) return true;
    t -= slope.distance / std::max(slope.gradient.squaredNorm(), 0.01) * slope.gradient;
    slope = slope_of(root, t);
  }
  return std::abs(slope.distance) <= 1e-12 * t.norm();
}

// Returns the part of the vector `way` that lies in the tangent plane.
Vec3 side_of(const Vec3& way, const Slope& slope) {
  const Vec3 normal = unit(slope.gradient);
  return way - way.dot(normal) * normal;
}

}  // namespace

double Shape::half_thickness() const {
  return thinnest_of(root, [](const ClosedSurface&) { return 0.0; });
}
double Shape::usual_half_thickness() const {
  return thinnest_of(root, [](const ClosedSurface& surface) { return surface.solid->usual_half_thickness(); });
}
double Shape::certainty() const { return certainty_of(root); }

SurfacePoint Shape::closest(const Vec3& point) const {
  if (const auto found = closest_of_one(root, point)) return *found;
  const Slope at_point = slope_of(root, point);
  const double sign = at_point.distance < 0 ? -1 : 1;
  Vec3 t = point - at_point.distance * at_point.gradient;
  Slope slope = slope_of(root, t);
  // The field nowhere rises faster than the distance, so a point of the surface that lies as far away as the field says
  // is the closest one.
  const double round_off = 1e-14 * (point.norm() + t.norm());
  if (std::abs(slope.distance) <= round_off && std::abs(at_point.gradient.squaredNorm() - 1) < 1e-12)
    return {t, at_point.gradient, at_point.distance};
  t = point;
  slope = at_point;
  if (!move_to_zero_set(root, t, slope)) {  // no surface was found: use the field's distance and normal
    const Vec3 normal = unit(at_point.gradient);
    return {point - at_point.distance * normal, normal, at_point.distance};
  }
  // Walks along the tangent plane until the normal leads to the point. A step that leads further away, as from beyond
  // the surface's radius of curvature or over an edge, is shortened; the other steps have the lengths of Barzilai and
  // Borwein, "Two-point step size gradient methods" (1988).
  constexpr int most_steps = 40;
  double length = 1;
  for (int step = 0; step < most_steps; ++step) {
    const Vec3 side = side_of(point - t, slope);
    if (side.norm() <= 1e-10 * (point - t).norm() || side.norm() <= round_off) break;
    Vec3 next = t + length * side;
    Slope there = slope_of(root, next);
    if (!move_to_zero_set(root, next, there) || (point - next).norm() > (point - t).norm()) {
      length *= 0.25;
      continue;
    }
    const double turned = (next - t).dot(side - side_of(point - next, there));
    length = turned > 0 ? std::clamp((next - t).squaredNorm() / turned, 1e-3, 10.0) : 1;
    t = next;
    slope = there;
  }
  return {t, unit(slope.gradient), sign * (point - t).norm()};
}

}  // namespace supple
