// Tests where triangles lie deepest in shapes, and the pieces of shapes.
#include "geometry/shapes/triangle_in_shape.h"

#include <gtest/gtest.h>

#include <random>

#include "geometry/shapes/shape_pieces.h"

namespace supple {
namespace triangle_in_shape_test {

Shape shape_of(const Primitive& primitive) {
  Shape shape;
  shape.root.parts.push_back({primitive});
  return shape;
}

Vec3 random_point(std::mt19937& random, double extent) {
  std::uniform_real_distribution<double> place(-extent, extent);
  return Vec3(place(random), place(random), place(random));
}

// Compares with the least distance of all points of a grid on the triangle; convex shapes have no other minimum. Deep
// inside shapes with edges, where the distance has ridges, the descent may end a little early.
TEST(TriangleInShape, FindsTheLeastDistanceToConvexShapes) {
  const std::pair<std::string, Shape> shapes[] = {
      {"sphere", shape_of(Sphere{0.3})},
      {"ellipsoid", shape_of(Ellipsoid{Vec3(0.2, 0.5, 0.3)})},
      {"capsule", shape_of(Capsule{Vec3(-0.3, 0, 0), Vec3(0.3, 0.1, 0), 0.05})},
      {"box", shape_of(Box{Vec3(0.1, 0.4, 0.2), 0})},
      {"cylinder", shape_of(Cylinder{0.2, 0.3, 0.02})},
      {"half space", shape_of(HalfSpace{Vec3::UnitY(), 0.1})}};
  for (const auto& [name, shape] : shapes) {
    std::mt19937 random(7);
    const ShapeProbe probe(shape);
    for (int trial = 0; trial < 200; ++trial) {
      const TriangleCorners corners = {random_point(random, 0.8), random_point(random, 0.8), random_point(random, 0.8)};
      double longest = 0, least = 1e300;
      for (int k = 0; k < 3; ++k) longest = std::max(longest, (corners[(k + 1) % 3] - corners[k]).norm());
      QueryMemory near;
      for (int i = 0; i <= 60; ++i) {
        for (int j = 0; j <= 60 - i; ++j) {
          const Vec3 p = (i * corners[0] + j * corners[1] + (60 - i - j) * corners[2]) / 60;
          least = std::min(least, shape.closest(p).distance);
        }
      }
      const TriangleInShape search(probe, shape.half_thickness(), corners, near);
      EXPECT_LE(search.bound(), least + 1e-12) << name;
      EXPECT_GE(search.distance_at_nearest_corner(), search.bound() - 1e-12) << name;
      const TriangleInShape::Descent found = search.descend();
      double reached = 1e300;
      for (int i = 0; i < found.count; ++i) {
        const TrianglePlace& place = found.places[i];
        EXPECT_NEAR(place.weights.sum(), 1, 1e-12);
        EXPECT_GE(place.weights.minCoeff(), 0);
        EXPECT_NEAR(place.surface.distance, shape.closest(place.point).distance, 1e-12);
        reached = std::min(reached, place.surface.distance);
      }
      EXPECT_LT(reached, least + (name == "box" || name == "cylinder" ? 0.06 : 0.02) * longest)
          << name << ", trial " << trial;
    }
  }
}

TEST(TriangleInShape, ClosestWeightsAreThoseOfTheClosestPoint) {
  std::mt19937 random(3);
  for (int trial = 0; trial < 300; ++trial) {
    const TriangleCorners corners = {random_point(random, 1), random_point(random, 1), random_point(random, 1)};
    const Vec3 p = random_point(random, 2), weights = closest_weights(corners, p);
    const auto at = [&](const Vec3& w) { return Vec3(w[0] * corners[0] + w[1] * corners[1] + w[2] * corners[2]); };
    EXPECT_NEAR(weights.sum(), 1, 1e-12);
    EXPECT_GE(weights.minCoeff(), -1e-15);
    for (int other = 0; other < 30; ++other) {
      Vec3 w = random_point(random, 1).cwiseAbs();
      w /= w.sum();
      EXPECT_LE((at(weights) - p).norm(), (at(w) - p).norm() + 1e-12);
    }
  }
}

// Compares with points of a grid on the triangle, the nearest of which is at most half a cell from the box.
TEST(TriangleInShape, MeetsABoxWhereItHasAPointInIt) {
  std::mt19937 random(11);
  constexpr int cells = 60;
  int met = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const TriangleCorners corners = {random_point(random, 1), random_point(random, 1), random_point(random, 1)};
    Bounds box;
    box.include(random_point(random, 0.6));
    box.include(random_point(random, 0.6));
    for (const double grown : {-0.05, 0.0, 0.1}) {
      double least = 1e300, cell = 0;
      for (int k = 0; k < 3; ++k) cell = std::max(cell, (corners[(k + 1) % 3] - corners[k]).norm() / cells);
      for (int i = 0; i <= cells; ++i) {
        for (int j = 0; j <= cells - i; ++j) {
          const Vec3 p = (i * corners[0] + j * corners[1] + (cells - i - j) * corners[2]) / cells;
          least = std::min(least, (box.lower - p).cwiseMax(p - box.upper).maxCoeff() - grown);
        }
      }
      const bool meets = meets_box(corners, box, grown);
      met += meets;
      if (meets) {
        EXPECT_LE(least, cell);
      } else {
        EXPECT_GT(least, 0);
      }
    }
  }
  EXPECT_GT(met, 200);
  EXPECT_LT(met, 1000);
}

TEST(ShapePieces, AreTheShapeTogether) {
  ShapePart inner{Sphere{0.2}};
  inner.to_local = Eigen::Translation3d(-0.3, 0, 0);
  ShapePart group{ShapeGroup{{inner, {Box{Vec3(0.1, 0.2, 0.3), 0.05}}}}};
  group.to_local.translate(Vec3(0, 0.4, 0));
  group.to_local.rotate(Eigen::AngleAxisd(0.5, Vec3::UnitX()));
  group.scale = 2;
  ShapePart mirrored{Capsule{Vec3(0.5, 0, 0), Vec3(0.7, 0.2, 0), 0.1}};
  mirrored.mirror_x = true;
  Shape shape;
  shape.root.parts = {group, mirrored, {HalfSpace{Vec3::UnitY(), -1}}};
  const std::vector<ShapePiece> pieces = pieces_of(shape);
  ASSERT_EQ(pieces.size(), 4u);
  EXPECT_DOUBLE_EQ(pieces[0].bulge, 0.4);
  EXPECT_DOUBLE_EQ(pieces[1].bulge, 0.1);
  EXPECT_EQ(pieces[2].bulge, 0);
  EXPECT_TRUE(std::isinf(pieces[3].bulge));
  std::mt19937 random(5);
  for (int trial = 0; trial < 200; ++trial) {
    const Vec3 p = random_point(random, 2);
    double least = 1e300;
    for (const ShapePiece& piece : pieces) least = std::min(least, piece.shape.distance(p));
    EXPECT_NEAR(least, shape.distance(p), 1e-12);
  }
  shape.root.parts[1].blend = 0.1;  // what is blended cannot be taken apart
  ASSERT_EQ(pieces_of(shape).size(), 1u);
  EXPECT_EQ(pieces_of(shape)[0].bulge, 0);
}

}  // namespace triangle_in_shape_test
}  // namespace supple
