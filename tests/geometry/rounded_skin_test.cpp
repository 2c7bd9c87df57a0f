// Tests how drawn surfaces are rounded off for large pictures.
#include "geometry/skins/rounded_skin.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <map>
#include <numbers>

#include "geometry/meshes/pose.h"
#include "support/surfaces.h"

namespace supple {
namespace rounded_skin_test {

constexpr double radius = 0.5, tube = 0.2;  // of a torus [m]

double off_torus(const Vec3& p) { return std::abs(std::hypot(std::hypot(p.x(), p.z()) - radius, p.y()) - tube); }

Skin plain_skin(const TriMesh& mesh) {
  std::vector<std::int32_t> vertex_of;
  return skin_of_surface(mesh.points, mesh.triangles, 0, vertex_of);
}

// Returns how far the middle of an edge is off at most, by this measure [m].
double worst_middle(const Skin& skin, const std::function<double(const Vec3&)>& off) {
  double worst = 0;
  for (Eigen::Index t = 0; t < skin.rest.triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const Vec3 a = skin.rest.points.row(skin.rest.triangles(t, k)),
                 b = skin.rest.points.row(skin.rest.triangles(t, (k + 1) % 3));
      worst = std::max(worst, off(0.5 * (a + b)));
    }
  }
  return worst;
}

// Expects each edge, as two places, to be run through once in each direction.
void expect_closed(const Skin& skin) {
  using Place = std::array<double, 3>;
  const auto place = [&](std::int32_t v) {
    return Place{skin.rest.points(v, 0), skin.rest.points(v, 1), skin.rest.points(v, 2)};
  };
  std::map<std::pair<Place, Place>, int> edges;
  for (Eigen::Index t = 0; t < skin.rest.triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) ++edges[{place(skin.rest.triangles(t, k)), place(skin.rest.triangles(t, (k + 1) % 3))}];
  }
  for (const auto& [edge, count] : edges) {
    ASSERT_EQ(count, 1);
    ASSERT_EQ(edges.count({edge.second, edge.first}), 1u) << "a gap";
  }
}

// Makes an upright prism with so many sides and a radius and height of a metre.
TriMesh prism(int sides) {
  TriMesh mesh{Positions(2 * sides + 2, 3), Triangles(4 * sides, 3)};
  for (int i = 0; i < sides; ++i) {
    const double turn = 2 * std::numbers::pi * i / sides;
    mesh.points.row(i) << std::cos(turn), 0, -std::sin(turn);
    mesh.points.row(sides + i) << std::cos(turn), 1, -std::sin(turn);
    const int next = (i + 1) % sides;
    mesh.triangles.row(4 * i) << i, next, sides + next;
    mesh.triangles.row(4 * i + 1) << i, sides + next, sides + i;
    mesh.triangles.row(4 * i + 2) << 2 * sides, next, i;
    mesh.triangles.row(4 * i + 3) << 2 * sides + 1, sides + i, sides + next;
  }
  mesh.points.row(2 * sides) << 0, 0, 0;
  mesh.points.row(2 * sides + 1) << 0, 1, 0;
  return mesh;
}

TEST(RoundedSkin, CurvesThroughTheEndsOfEdgesComeNearToARoundSurface) {
  Skin skin = plain_skin(test::torus_surface(radius, tube, 32, 16));
  const double before = worst_middle(skin, off_torus);
  const Positions old = skin.rest.points;
  ASSERT_FALSE(round_off(skin, {0.01, 0.0005}, nullptr).empty());
  EXPECT_LT(worst_middle(skin, off_torus), before / 6);
  EXPECT_EQ(skin.rest.points.topRows(old.rows()), old);
  EXPECT_EQ(Eigen::Index(skin.occlusion.size()), skin.rest.points.rows());
  EXPECT_EQ(Eigen::Index(skin.paint.size()), skin.rest.points.rows());
  expect_closed(skin);
}

TEST(RoundedSkin, ShortOrStraightEdgesAreLeftAlone) {
  Skin skin = plain_skin(test::torus_surface(radius, tube, 32, 16));
  EXPECT_TRUE(round_off(skin, {0.5, 0.0005}, nullptr).empty()) << "no edge is so long";
  EXPECT_TRUE(round_off(skin, {0.01, 0.1}, nullptr).empty()) << "no edge is so far off";
  EXPECT_EQ(skin.rest.triangles.rows(), 2 * 32 * 16);
  Skin cube = plain_skin(prism(4));
  EXPECT_TRUE(round_off(cube, {0.01, 0.0005}, nullptr).empty()) << "its faces are flat, and its edges are sharp";
}

TEST(RoundedSkin, SharpEdgesStayWhereTheyAre) {
  Skin skin = plain_skin(prism(12));
  ASSERT_FALSE(round_off(skin, {0.02, 0.002}, nullptr).empty());
  expect_closed(skin);
  double furthest = 0;
  for (Eigen::Index v = 0; v < skin.rest.points.rows(); ++v) {
    const Vec3 at = skin.rest.points.row(v);
    if (at.y() == 0 || at.y() == 1) {
      EXPECT_TRUE(v < Eigen::Index(4 * 12 + 2)) << "a new vertex on a rim or a lid";
    }
    furthest = std::max(furthest, std::hypot(at.x(), at.z()));
  }
  EXPECT_LT(furthest, 1.01);
}

// A ball of a metre with a round spot, in a frame that is turned, moved and twice as large.
TEST(RoundedSkin, NewVerticesLieOnTheShapeAndKnowItsPaint) {
  Shape shape;
  shape.root.parts.emplace_back().primitive = Sphere{1};
  PaintLayer spot{"spot", Vec3::Zero(), 0.2, 0.01, {}};
  ShapePart cap;
  cap.primitive = Sphere{0.3};
  cap.to_local = Eigen::Isometry3d(Eigen::Translation3d(-1, 0, 0));
  spot.area.parts.push_back(cap);
  shape.paint.push_back(spot);
  Skin skin = skin_of(shape, 0.2);
  Eigen::Affine3d placement = no_placement();
  placement.translate(Vec3(3, 1, 2)).rotate(Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized())).scale(2);
  for (Eigen::Index v = 0; v < skin.rest.points.rows(); ++v)
    skin.rest.points.row(v) = (placement * Vec3(skin.rest.points.row(v))).transpose();
  const auto off_ball = [](const Vec3& p) { return std::abs((p - Vec3(3, 1, 2)).norm() - 2); };
  // Returns how far the border of the spot, where it crosses an edge, is from where it should be at most [m].
  const auto off_border = [&](const Skin& of) {
    double worst = 0;
    for (Eigen::Index t = 0; t < of.rest.triangles.rows(); ++t) {
      for (int k = 0; k < 3; ++k) {
        const std::int32_t a = of.rest.triangles(t, k), b = of.rest.triangles(t, (k + 1) % 3);
        const double at_a = of.paint[std::size_t(a)][0], at_b = of.paint[std::size_t(b)][0];
        if (at_a >= 0 || at_b < 0) continue;
        const Vec3 border = (at_b * of.rest.points.row(a) - at_a * of.rest.points.row(b)) / (at_b - at_a);
        worst = std::max(worst, 2 * std::abs(distance(shape.paint[0].area, placement.inverse() * border)));
      }
    }
    return worst;
  };
  const double before = worst_middle(skin, off_ball), border_before = off_border(skin);
  ASSERT_GT(before, 0.01);
  const ExactSurface exact{shape, placement};
  ASSERT_FALSE(round_off(skin, {0.02, 0.003}, &exact).empty());
  EXPECT_LT(worst_middle(skin, off_ball), 0.004);
  EXPECT_LT(off_border(skin), border_before / 4);
  for (Eigen::Index v = 0; v < skin.rest.points.rows(); ++v) ASSERT_LT(off_ball(skin.rest.points.row(v)), 0.001);
  expect_closed(skin);
}

// Triangles cut the sharp edges of a shape off a little, which is one straight line as long as they are not halved.
TEST(RoundedSkin, SharpEdgesOfAShapeDoNotBecomeScallops) {
  Shape shape;
  shape.root.parts.emplace_back().primitive = Box{Vec3(0.5, 0.31, 0.23), 0.0};
  Skin skin = skin_of(shape, 0.07);
  const ExactSurface exact{shape, no_placement()};
  EXPECT_TRUE(round_off(skin, {0.005, 0.001}, &exact).empty());
}

}  // namespace rounded_skin_test
}  // namespace supple
