// Tests closest points of shapes: they lie on the zero set, at the field's distance and along its slope, for every
// primitive and every combination; where the field is no distance, they are compared with brute force.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "geometry/shapes/shape.h"
#include "geometry/skins/skin.h"
#include "geometry/solids/triangle_solid.h"
#include "support/surfaces.h"

namespace supple {
namespace shape_closest_test {

struct NamedShape {
  std::string name;
  Shape shape;
};

Vec3 random_in(std::mt19937& random, const Vec3& half) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  const double x = uniform(random), y = uniform(random), z = uniform(random);
  return half.cwiseProduct(Vec3(x, y, z));
}

ShapePart part_of(Primitive primitive, Combine combine = Combine::add, double blend = 0) {
  ShapePart part;
  part.primitive = std::move(primitive);
  part.combine = combine;
  part.blend = blend;
  return part;
}

ShapePart moved(ShapePart part, const Vec3& by) {
  part.to_local = part.to_local * Eigen::Translation3d(-by);
  return part;
}

Eigen::Isometry3d askew() {
  Eigen::Isometry3d to_parent = Eigen::Isometry3d::Identity();
  to_parent.translate(Vec3(0.7, -0.3, 0.2)).rotate(Eigen::AngleAxisd(1.1, Vec3(1, 2, -0.5).normalized()));
  return to_parent.inverse();
}

Shape shape_of(std::vector<ShapePart> parts) {
  Shape shape;
  shape.root.parts = std::move(parts);
  return shape;
}

ShapePart scaled_and_askew(Primitive primitive, double scale) {
  ShapePart part = part_of(std::move(primitive));
  part.scale = scale;
  part.to_local = askew();
  return part;
}

const ShapeGroup ball_in_group = {{part_of(Sphere{0.6})}};

const std::pair<const char*, Primitive> exact_primitives[] = {
    {"sphere", Sphere{0.8}},
    {"capsule", Capsule{Vec3(-0.3, 0.1, 0), Vec3(0.5, 0.7, 0.4), 0.3}},
    {"capsule without length", Capsule{Vec3(0.2, 0, 0), Vec3(0.2, 0, 0), 0.5}},
    {"round cone", RoundCone{Vec3(-0.3, 0.1, 0), Vec3(0.5, 0.7, 0.4), 0.5, 0.15}},
    {"round cone the other way", RoundCone{Vec3(0, -0.5, 0), Vec3(0, 0.6, 0), 0.1, 0.4}},
    {"round cone of a ball in a ball", RoundCone{Vec3(0, 0, 0), Vec3(0.1, 0, 0), 0.7, 0.2}},
    {"box", Box{Vec3(0.9, 0.6, 0.4), 0}},
    {"round box", Box{Vec3(0.9, 0.6, 0.4), 0.15}},
    {"box round all through", Box{Vec3(0.9, 0.6, 0.4), 0.4}},
    {"cylinder", Cylinder{0.5, 0.7, 0}},
    {"round cylinder", Cylinder{0.5, 0.7, 0.2}},
    {"torus", Torus{0.8, 0.3}},
    {"half space", HalfSpace{Vec3(1, 2, -2) / 3, 0.2}},
    {"surface", ClosedSurface{std::make_shared<TriangleSolid>(test::box_surface(Vec3(0.8, 0.5, 0.3)))}},
    {"group of one", ball_in_group},
};

// Lists every primitive whose field is its distance, both as it is and scaled, rotated and moved.
std::vector<NamedShape> exact_shapes() {
  std::vector<NamedShape> shapes;
  for (const auto& [name, primitive] : exact_primitives) {
    shapes.push_back({name, shape_of({part_of(primitive)})});
    shapes.push_back({std::string(name) + ", small and askew", shape_of({scaled_and_askew(primitive, 0.4)})});
    shapes.push_back({std::string(name) + ", large and askew", shape_of({scaled_and_askew(primitive, 1.7)})});
  }
  return shapes;
}

// Lists shapes whose field isn't the distance, without edges where two surfaces meet.
std::vector<NamedShape> smooth_shapes() {
  const Ellipsoid egg{Vec3(0.9, 0.6, 0.4)};
  ShapePart pair = scaled_and_askew(egg, 0.5);
  pair.mirror_x = true;
  const ShapeGroup melted = {
      {part_of(Sphere{0.6}), moved(part_of(Box{Vec3(0.5, 0.3, 0.3), 0.1}, Combine::add, 0.2), Vec3(0.6, 0.1, 0))}};
  ShapePart inner = scaled_and_askew(melted, 0.8);
  return {
      {"ellipsoid", shape_of({part_of(egg)})},
      {"ellipsoid askew", shape_of({scaled_and_askew(egg, 1.3)})},
      {"mirrored ellipsoids", shape_of({pair})},
      {"melted", shape_of(melted.parts)},
      {"melted in a group", shape_of({inner})},
      {"melted ellipsoids",
       shape_of({part_of(egg), moved(part_of(Ellipsoid{Vec3(0.3, 0.5, 0.7)}, Combine::add, 0.3), Vec3(0.6, 0.2, 0))})},
      {"cut with a blend",
       shape_of({part_of(Sphere{0.8}), moved(part_of(Sphere{0.5}, Combine::cut, 0.25), Vec3(0.7, 0.2, 0))})},
      {"intersected with a blend",
       shape_of({part_of(Sphere{0.8}), moved(part_of(Torus{0.8, 0.5}, Combine::intersect, 0.3), Vec3(0.3, 0, 0))})}};
}

// Lists such shapes with edges.
std::vector<NamedShape> edged_shapes() {
  ShapePart pair = scaled_and_askew(Box{Vec3(0.4, 0.3, 0.2), 0}, 1.2);
  pair.mirror_x = true;
  ShapePart block = part_of(Box{Vec3(0.5, 0.7, 0.4), 0}, Combine::intersect);
  block.to_local = askew();
  return {{"mirrored boxes", shape_of({pair})},
          {"two balls", shape_of({part_of(Sphere{0.6}), moved(part_of(Sphere{0.5}), Vec3(0.6, 0.1, 0))})},
          {"cut", shape_of({part_of(Sphere{0.8}), moved(part_of(Sphere{0.5}, Combine::cut), Vec3(0.7, 0.2, 0))})},
          {"intersected", shape_of({part_of(Sphere{0.9}), block})}};
}

TEST(ShapeClosest, OfExactShapesIsOnTheZeroSetAtTheFieldsDistanceAlongTheNormal) {
  for (const auto& [name, shape] : exact_shapes()) {
    const Bounds box = shape.bounds();
    const bool bounded = box.diagonal() < 1e3;
    std::mt19937 random(1);
    double off_surface = 0, off_field = 0, off_line = 0, off_unit = 0;
    int inside = 0;
    for (int i = 0; i < 4000; ++i) {
      const Vec3 p = bounded && i % 2 ? Vec3(box.center() + random_in(random, 0.6 * box.extent()))
                                      : random_in(random, Vec3::Constant(2.5));
      const SurfacePoint found = shape.closest(p);
      inside += found.distance < 0;
      off_surface = std::max(off_surface, std::abs(shape.distance(found.point)));
      off_field = std::max(off_field, std::abs(found.distance - shape.distance(p)));
      off_line = std::max(off_line, (found.point + found.distance * found.normal - p).norm());
      off_unit = std::max(off_unit, std::abs(found.normal.norm() - 1));
    }
    EXPECT_GT(inside, 30) << name;
    EXPECT_LT(off_surface, 1e-13) << name;
    EXPECT_LT(off_field, 1e-13) << name;
    EXPECT_LT(off_line, 1e-13) << name;
    EXPECT_LT(off_unit, 1e-14) << name;
  }
}

// Some point of the surface lies at the distance found. If that distance changes no faster than the query moves, no
// point is closer.
TEST(ShapeClosest, DistancesOfExactShapesNeverChangeFasterThanTheirPointMoves) {
  for (const auto& [name, shape] : exact_shapes()) {
    std::mt19937 random(2);
    double steepest = 0;
    for (int i = 0; i < 4000; ++i) {
      const Vec3 p = random_in(random, Vec3::Constant(2)), q = p + random_in(random, Vec3::Constant(i % 2 ? 1 : 0.05));
      steepest = std::max(steepest, std::abs(shape.closest(p).distance - shape.closest(q).distance) / (p - q).norm());
    }
    EXPECT_LT(steepest, 1 + 1e-10) << name;
  }
}

// The slope is taken a thousandth above the surface, or below it for a query inside. There the field has a slope even
// near an edge, though this slope turns by up to a thousand times the step.
TEST(ShapeClosest, NormalsOfExactShapesAreTheFieldsSlope) {
  constexpr double above = 1e-3, step = 1e-6;
  for (const auto& [name, shape] : exact_shapes()) {
    std::mt19937 random(3);
    double worst = 0;
    int compared = 0, kinks = 0;
    for (int i = 0; i < 2000; ++i) {
      const Vec3 p = random_in(random, Vec3::Constant(1.5));
      const SurfacePoint found = shape.closest(p);
      if (std::abs(found.distance) < 3 * above) continue;
      const Vec3 near = found.point + std::copysign(above, found.distance) * found.normal;
      const Vec3 slope = shape.gradient(near, step);
      ++compared;
      if (std::abs(slope.norm() - 1) > 1e-6) {
        ++kinks;
      } else {
        worst = std::max(worst, (slope - found.normal).norm());
      }
    }
    EXPECT_GT(compared, 1500) << name;
    EXPECT_LT(kinks, 10) << name;
    EXPECT_LT(worst, 1e3 * step) << name;
  }
}

TEST(ShapeClosest, OfSmoothShapesIsOnTheZeroSetAndItsNormalLeadsToThePoint) {
  for (const auto& [name, shape] : smooth_shapes()) {
    std::mt19937 random(4);
    double off_surface = 0, off_distance = 0, off_line = 0, off_slope = 0, off_unit = 0;
    int inside = 0, outside = 0;
    while (inside < 300 || outside < 300) {
      const Vec3 p = random_in(random, Vec3::Constant(1.6));
      const double field = shape.distance(p);
      if (field < -0.03 || field > 0.3) continue;
      field < 0 ? ++inside : ++outside;
      const SurfacePoint found = shape.closest(p);
      EXPECT_EQ(found.distance < 0, field < 0) << name << " at " << p.transpose();
      off_surface = std::max(off_surface, std::abs(shape.distance(found.point)));
      off_distance = std::max(off_distance, std::abs(std::abs(found.distance) - (p - found.point).norm()));
      off_line = std::max(off_line, (found.point + found.distance * found.normal - p).norm());
      // The query lies just above the surface, because an ellipsoid's field has a kink on it.
      const Vec3 above = found.point + 1e-5 * found.normal;
      off_slope = std::max(off_slope, (shape.gradient(above, 1e-6).normalized() - found.normal).norm());
      off_unit = std::max(off_unit, std::abs(found.normal.norm() - 1));
    }
    EXPECT_LT(off_surface, 1e-12) << name;
    EXPECT_LT(off_distance, 1e-14) << name;
    EXPECT_LT(off_line, 1e-3) << name;
    EXPECT_LT(off_slope, 2e-4) << name;
    EXPECT_LT(off_unit, 1e-14) << name;
  }
}

TEST(ShapeClosest, OfShapesWithEdgesIsOnTheZeroSet) {
  for (const auto& [name, shape] : edged_shapes()) {
    std::mt19937 random(5);
    double off_surface = 0, off_distance = 0, off_unit = 0, short_of = 0;
    int inside = 0, off_line = 0;
    constexpr int queries = 2000;
    for (int i = 0; i < queries; ++i) {
      const Vec3 p = random_in(random, Vec3::Constant(1.2));
      const double field = shape.distance(p);
      const SurfacePoint found = shape.closest(p);
      inside += field < 0;
      EXPECT_EQ(found.distance < 0, field < 0) << name << " at " << p.transpose();
      off_surface = std::max(off_surface, std::abs(shape.distance(found.point)));
      off_distance = std::max(off_distance, std::abs(std::abs(found.distance) - (p - found.point).norm()));
      off_unit = std::max(off_unit, std::abs(found.normal.norm() - 1));
      short_of = std::max(short_of, std::abs(field) - std::abs(found.distance));
      off_line += (found.point + found.distance * found.normal - p).norm() > 1e-6;
    }
    EXPECT_GT(inside, 30) << name;
    EXPECT_LT(off_surface, 1e-9) << name;
    EXPECT_LT(off_distance, 1e-14) << name;
    EXPECT_LT(off_unit, 1e-14) << name;
    EXPECT_LT(short_of, 1e-9) << name;         // the field never overstates
    EXPECT_LT(off_line, queries / 4) << name;  // those that are closest to an edge
  }
}

TEST(ShapeClosest, OfNothingIsAsTheFieldHasIt) {
  const Shape nothings[] = {
      {}, shape_of({part_of(Sphere{1}, Combine::cut)}), shape_of({part_of(Sphere{1}, Combine::intersect)})};
  for (const Shape& nothing : nothings) EXPECT_EQ(nothing.closest(Vec3(0.5, 0, 0)).distance, 1e9);
  const Shape apart = shape_of({part_of(Sphere{1}), moved(part_of(Sphere{1}, Combine::intersect), Vec3(4, 0, 0))});
  for (const Vec3& p : {Vec3(0, 0, 0), Vec3(2, 0, 0), Vec3(2.1, 0.3, 0), Vec3(9, 0, 0)}) {
    const SurfacePoint found = apart.closest(p);
    EXPECT_EQ(found.distance, apart.distance(p)) << p.transpose();
    EXPECT_GE(found.distance, 1) << p.transpose();
    EXPECT_NEAR(found.normal.norm(), 1, 1e-14) << p.transpose();
    EXPECT_TRUE(found.point.allFinite()) << p.transpose();
  }
}

Positions sampled(const Ellipsoid& ellipsoid, int around, int rings) {
  Positions points(around * rings, 3);
  for (int j = 0; j < rings; ++j) {
    for (int i = 0; i < around; ++i) {
      const double s = 2 * std::numbers::pi * i / around, t = std::numbers::pi * (j + 0.5) / rings;
      const Vec3 on_ball(std::sin(t) * std::cos(s), std::cos(t), std::sin(t) * std::sin(s));
      points.row(j * around + i) = ellipsoid.radii.cwiseProduct(on_ball).transpose();
    }
  }
  return points;
}

double distance_by_brute_force(const Positions& surface, const Vec3& p) {
  return std::sqrt((surface.rowwise() - p.transpose()).rowwise().squaredNorm().minCoeff());
}

const Vec3 elongated[] = {Vec3(1, 1, 1),         Vec3(0.9, 0.6, 0.4), Vec3(1, 0.5, 0.5), Vec3(1, 1, 0.3),
                          Vec3(0.25, 1.0, 0.25), Vec3(1, 0.1, 0.4),   Vec3(1, 0.1, 0.1), Vec3(1, 1, 0.05)};

TEST(ShapeClosest, OfAnEllipsoidNoSampleOfTheSurfaceIsCloser) {
  for (const Vec3& radii : elongated) {
    const Ellipsoid ellipsoid{radii};
    const Shape shape = shape_of({part_of(ellipsoid)});
    const Positions surface = sampled(ellipsoid, 240, 120);
    const double curvature_radius = std::pow(radii.minCoeff(), 2) / radii.maxCoeff();  // the smallest one
    std::mt19937 random(6);
    double worst = -1, off_surface = 0;
    int inside = 0, outside = 0;
    while (inside < 60 || outside < 300) {
      // Half of the queries lie close to the surface.
      Vec3 p = random_in(random, 2 * radii);
      if (outside % 2)
        p *= (1 + std::uniform_real_distribution<double>(-0.1, 0.1)(random)) / p.cwiseQuotient(radii).norm();
      const double field = shape.distance(p);
      const double closest_sample = distance_by_brute_force(surface, p);
      if (field < 0 && closest_sample > 0.9 * curvature_radius) continue;
      field < 0 ? ++inside : ++outside;
      const SurfacePoint found = shape.closest(p);
      worst = std::max(worst, std::abs(found.distance) / closest_sample - 1);
      off_surface = std::max(off_surface, std::abs(found.point.cwiseQuotient(radii).norm() - 1));
    }
    EXPECT_LT(worst, 1e-6) << radii.transpose();
    EXPECT_LT(off_surface, 1e-12) << radii.transpose();
  }
}

TEST(ShapeClosest, CertaintyTimesTheFieldNeverExceedsTheDistanceToAnEllipsoid) {
  for (const Vec3& radii : elongated) {
    const Ellipsoid ellipsoid{radii};
    const Shape shape = shape_of({part_of(ellipsoid)});
    EXPECT_DOUBLE_EQ(shape.certainty(), radii.minCoeff() / radii.maxCoeff());
    const Positions surface = sampled(ellipsoid, 240, 120);
    std::mt19937 random(7);
    for (int i = 0; i < 600; ++i) {
      const Vec3 p = random_in(random, (i % 3 == 0 ? 20 : i % 3 == 1 ? 1.5 : 0.7) * radii);
      EXPECT_LE(std::abs(shape.distance(p)) * shape.certainty(), distance_by_brute_force(surface, p) * (1 + 1e-9))
          << radii.transpose() << " at " << p.transpose();
    }
  }
}

TEST(ShapeClosest, CertaintyTimesTheFieldNeverExceedsTheDistanceToWhatIsMadeOfEllipsoids) {
  const Ellipsoid needle{Vec3(1, 0.2, 0.2)}, disc{Vec3(0.8, 0.8, 0.2)};
  const ShapeGroup group = {{part_of(needle)}};
  const NamedShape shapes[] = {
      {"united", shape_of({part_of(needle), moved(part_of(disc), Vec3(0.5, 0.4, 0))})},
      {"melted", shape_of({part_of(needle), moved(part_of(disc, Combine::add, 0.3), Vec3(0.5, 0.4, 0))})},
      {"melted groups", shape_of({part_of(group), moved(part_of(Sphere{0.3}, Combine::add, 0.4), Vec3(1.2, 0.1, 0))})},
      {"cut with a blend", shape_of({part_of(Sphere{0.8}), moved(part_of(disc, Combine::cut, 0.3), Vec3(0, 0, 0.7))})}};
  for (const auto& [name, shape] : shapes) {
    const Positions surface = contour(shape, 0.03).points;
    std::mt19937 random(9);
    double worst = 0;
    for (int i = 0; i < 3000; ++i) {
      const Vec3 p = random_in(random, Vec3::Constant(i % 2 ? 1.2 : 4));
      const double sampled_distance = distance_by_brute_force(surface, p);
      if (sampled_distance < 0.05) continue;  // the samples are 0.03 apart
      worst = std::max(worst, std::abs(shape.distance(p)) * shape.certainty() / sampled_distance);
    }
    EXPECT_LT(worst, 1) << name;
    EXPECT_GT(worst, 0.02) << name;
  }
}

TEST(ShapeClosest, CertaintyIsThatOfTheLeastCertainPart) {
  for (const auto& [name, shape] : exact_shapes()) EXPECT_EQ(shape.certainty(), 1) << name;
  const Ellipsoid egg{Vec3(1, 0.5, 0.8)};
  const ShapeGroup inner = {{part_of(Sphere{1}), part_of(egg, Combine::cut)}};
  ShapePart small = part_of(inner);
  small.scale = 0.1;
  EXPECT_EQ(shape_of({part_of(Ellipsoid{Vec3(2, 1.5, 2)}), small}).certainty(), 0.5);
  EXPECT_EQ(shape_of({part_of(Sphere{1}), part_of(egg, Combine::add, 0.1)}).certainty(), 0.25);
  EXPECT_EQ(shape_of({part_of(Sphere{1}), part_of(Box{Vec3::Ones(), 0}, Combine::add, 0.2)}).certainty(), 1);
}

TEST(ShapeClosest, HalfThicknessIsTheThinnestPartsAndNothingLongerHidesInIt) {
  const std::pair<Primitive, double> expected[] = {
      {Sphere{0.8}, 0.8},
      {Ellipsoid{Vec3(0.9, 0.6, 0.4)}, 0.4},
      {Capsule{Vec3::Zero(), Vec3::UnitX(), 0.3}, 0.3},
      {RoundCone{Vec3::Zero(), Vec3::UnitX(), 0.5, 0.15}, 0.15},
      {Box{Vec3(0.9, 0.6, 0.4), 0.1}, 0.4},
      {Cylinder{0.5, 0.7, 0}, 0.5},
      {Cylinder{0.5, 0.2, 0}, 0.2},
      {Torus{0.8, 0.3}, 0.3},
      {ClosedSurface{std::make_shared<TriangleSolid>(test::box_surface(Vec3::Ones()))}, 0},
      {ball_in_group, 0.6}};
  for (const auto& [primitive, half] : expected) {
    const Shape as_is = shape_of({part_of(primitive)}), large = shape_of({scaled_and_askew(primitive, 3)});
    EXPECT_EQ(as_is.half_thickness(), half) << primitive.index();
    EXPECT_DOUBLE_EQ(large.half_thickness(), 3 * half) << primitive.index();
    std::mt19937 random(8);
    double deepest = 0;
    for (int i = 0; i < 20000; ++i) deepest = std::min(deepest, as_is.distance(random_in(random, Vec3::Ones())));
    EXPECT_LE(half, 1.1 * -deepest) << primitive.index();
  }
  EXPECT_GT(shape_of({part_of(HalfSpace{Vec3::UnitY(), 0})}).half_thickness(), 1e100);
  EXPECT_EQ(shape_of({part_of(Sphere{0.8}), part_of(Torus{1, 0.1})}).half_thickness(), 0.1);
  EXPECT_EQ(shape_of({part_of(Sphere{0.8}), part_of(Sphere{0.1}, Combine::cut)}).half_thickness(), 0);
  EXPECT_EQ(shape_of({part_of(Sphere{0.8}), part_of(Sphere{0.9}, Combine::intersect)}).half_thickness(), 0);
}

// Lists centres, axes, corners and edges in the primitives' own frames, and places that differ from these in the last
// bits only.
std::vector<Vec3> awkward_places(const Primitive& primitive) {
  std::vector<Vec3> places = {Vec3::Zero(),         Vec3(1e6, 0, 0),  Vec3(0, -1e6, 0), Vec3(0, 0, 1e6),
                              Vec3(-1e6, 1e6, 3e5), Vec3(0, 0.35, 0), Vec3(0, 0.7, 0),  Vec3(0, -2, 0)};
  if (const auto* c = std::get_if<Capsule>(&primitive))
    for (const double s : {-0.5, 0.0, 0.3, 0.7, 1.0, 1.5}) places.push_back(c->from + s * (c->to - c->from));
  if (const auto* c = std::get_if<RoundCone>(&primitive))
    for (const double s : {-0.5, 0.0, 0.3, 0.7, 1.0, 1.5}) places.push_back(c->from + s * (c->to - c->from));
  if (const auto* b = std::get_if<Box>(&primitive))
    for (const Vec3& corner : {Vec3(1, 1, 1), Vec3(-1, 1, -1), Vec3(0, 1, 1), Vec3(1, 0, 1), Vec3(0, 0, 1)})
      for (const double s : {0.5, 1.0, 2.0}) places.push_back(s * corner.cwiseProduct(b->half));
  if (const auto* c = std::get_if<Cylinder>(&primitive))
    for (const double angle : {0.0, 0.3, 2.0})
      for (const double s : {0.5, 1.0, 2.0})
        places.push_back(s * Vec3(c->radius * std::cos(angle), c->half_height, c->radius * std::sin(angle)));
  if (const auto* t = std::get_if<Torus>(&primitive))
    for (int i = 0; i < 40; ++i) places.push_back(t->radius * Vec3(std::cos(0.16 * i), 0, std::sin(0.16 * i)));
  if (const auto* s = std::get_if<ClosedSurface>(&primitive))
    for (Eigen::Index v = 0; v < s->solid->surface().points.rows(); ++v)
      places.push_back(s->solid->surface().points.row(v));
  const std::size_t exactly = places.size();
  for (std::size_t i = 0; i < exactly; ++i)
    for (const double by : {1e-17, 1e-16, 1e-12}) places.push_back(places[i] + by * Vec3(0.6, 0, -0.8));
  return places;
}

TEST(ShapeClosest, IsFiniteAndOnTheSurfaceAtCentresAxesEdgesCornersAndFarAway) {
  for (const auto& [name, primitive] : exact_primitives) {
    for (const bool turned : {false, true}) {
      const ShapePart part = turned ? scaled_and_askew(primitive, 1.3) : part_of(primitive);
      const Shape shape = shape_of({part});
      for (const Vec3& place : awkward_places(primitive)) {
        const Vec3 p = part.to_local.inverse() * Vec3(part.scale * place);
        const SurfacePoint found = shape.closest(p);
        const double tolerance = 1e-14 * (10 + p.norm());
        EXPECT_NEAR(found.normal.norm(), 1, 1e-14) << name << " at " << place.transpose();
        EXPECT_NEAR(found.distance, shape.distance(p), tolerance) << name << " at " << place.transpose();
        EXPECT_NEAR(shape.distance(found.point), 0, tolerance) << name << " at " << place.transpose();
        EXPECT_NEAR((p - found.point).norm(), std::abs(found.distance), tolerance)
            << name << " at " << place.transpose();
      }
    }
  }
}

TEST(ShapeClosest, IsFiniteAndOnTheSurfaceOfSmoothAndEdgedShapesToo) {
  std::vector<NamedShape> shapes = smooth_shapes();
  for (NamedShape& more : edged_shapes()) shapes.push_back(std::move(more));
  for (const Vec3& radii : elongated) shapes.push_back({"ellipsoid", shape_of({part_of(Ellipsoid{radii})})});
  for (const auto& [name, shape] : shapes) {
    for (const Vec3& p : awkward_places(shape.root.parts.front().primitive)) {
      const SurfacePoint found = shape.closest(p);
      EXPECT_NEAR(found.normal.norm(), 1, 1e-14) << name << " at " << p.transpose();
      EXPECT_TRUE(std::isfinite(found.distance)) << name << " at " << p.transpose();
      EXPECT_EQ(found.distance < 0, shape.distance(p) < 0) << name << " at " << p.transpose();
      EXPECT_NEAR(shape.distance(found.point), 0, 1e-6) << name << " at " << p.transpose();
    }
  }
}

}  // namespace shape_closest_test
}  // namespace supple
