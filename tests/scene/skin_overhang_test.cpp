// Tests how far a drawn skin reaches beyond its elements, and that bodies which touch each other are kept apart there.
#include "scene/building/skin_overhang.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "baselines/make_rule.h"
#include "geometry/triangles/moving_surface.h"
#include "scene/building/drawn_body.h"
#include "support/scene_text.h"
#include "world/world.h"

namespace supple {
namespace skin_overhang_test {

std::string ball(const std::string& name, double scale, const std::string& keys) {
  return fmt::format(
      "[[body]]\nname = \"{}\"\nshape = \"shapes/sphere.toml\"\nscale = {}\nvertices = 600\nskin_cells = 24\n"
      "material = {{ model = \"stable-neo-hookean\", young = 1e5, poisson = 0.4 }}\n{}\n",
      name, scale, keys);
}

std::vector<Body> bodies_of(const std::string& text) { return assemble(test::scene_of(text)); }

TEST(SkinOverhang, OfABallIsWhatItsTrianglesLackAtMost) {
  for (const double scale : {0.1, 3.0}) {
    const std::vector<Body> bodies = bodies_of(ball("a", scale, "") + ball("b", scale, "position = [9, 0, 0]"));
    const Body& body = bodies.front();
    const Positions& rest = body.description.mesh.rest;
    const Vec3 middle = body.placement * Vec3(0, 1, 0);
    const double radius = scale;
    std::vector<double> expected(std::size_t(rest.rows()));
    const Triangles surface = surface_of(body);
    for (const auto& t : surface.rowwise()) {
      const Vec3 center = (rest.row(t[0]) + rest.row(t[1]) + rest.row(t[2])).transpose() / 3;
      for (int k = 0; k < 3; ++k) {
        double& most = expected[std::size_t(t[k])];
        most = std::max(most, radius - (center - middle).norm());
      }
    }
    // Smoothing moves the overhang from vertex to vertex, and keeps its mean.
    double sum = 0, expected_sum = 0;
    for (std::size_t v = 0; v < expected.size(); ++v) {
      const double overhang = body.description.overhang[v];
      EXPECT_EQ(overhang > 0, expected[v] > 0) << v;
      EXPECT_LE(overhang, 0.004 * bounds_of(rest).diagonal()) << v;
      EXPECT_LE(std::abs(overhang - expected[v]), 0.6 * expected[v]) << v;
      sum += overhang;
      expected_sum += expected[v];
    }
    EXPECT_GT(expected_sum, 0);
    EXPECT_NEAR(sum / expected_sum, 1, 0.1);
  }
}

TEST(SkinOverhang, IsNotThereWhereNoOtherBodyOrNoSkinIs) {
  EXPECT_TRUE(bodies_of(ball("alone", 0.1, "")).front().description.overhang.empty());
  const std::string box =
      "[[body]]\nname = \"box\"\nbox = { extent = [0.2, 0.2, 0.2], cells = [2, 2, 2] }\nposition = [3, 0, 0]\n"
      "material = { model = \"corotated\", mu = 1e4, lambda = 1e4 }\n";
  const std::vector<Body> bodies = bodies_of(ball("ball", 0.1, "") + box);
  EXPECT_FALSE(bodies.front().description.overhang.empty());
  EXPECT_TRUE(bodies.back().description.overhang.empty());
}

// Returns how deep the skins of two bodies are in each other, negative where they are apart [m].
double depth_of_skins(const World& world, const std::vector<DrawnBody>& drawn) {
  std::vector<Positions> points;
  std::vector<MovingSurface> surfaces;
  for (std::size_t b = 0; b < 2; ++b) {
    const MovingBody& body = world.body(b);
    points.push_back(embedded_points(drawn[b].embedding, in_input_order(body.model(), body.state().x)));
    surfaces.emplace_back(drawn[b].skin.rest.triangles, points.back());
  }
  double deepest = -1;
  for (std::size_t b = 0; b < 2; ++b) {
    for (const auto& point : points[b].rowwise()) {
      const auto place = surfaces[1 - b].closest_at_start(point.transpose(), 1);
      if (place) deepest = std::max(deepest, -place->distance);
    }
  }
  return deepest;
}

// Without the overhang, the skins of these balls are up to 1 % of their size in each other.
TEST(SkinOverhang, KeepsTheSkinsOfTwoBallsApartButNotFar) {
  const std::string text = "frames = 60\n[solver]\ndamping = 0.002\n" + ball("lower", 0.1, "") +
                           ball("upper", 0.1, "position = [0, 0.21, 0]") +
                           "[[collider]]\nshape = { half_space = { normal = [0, 1, 0] } }\n";
  double without = 0;
  for (const bool counts : {false, true}) {
    const SceneDef scene = test::scene_of(text);
    std::vector<Body> bodies = assemble(scene);
    const std::vector<DrawnBody> drawn = drawn_bodies(bodies);
    if (!counts) {
      for (Body& body : bodies) body.description.overhang.clear();
    }
    Threads threads(1);
    World world(scene, std::move(bodies));
    world.start({make_rule, settings_of}, &threads);
    const double size = world.body(0).model().size;
    for (int frame = 0; frame < 60; ++frame) ASSERT_TRUE(world.play(frame)) << frame;
    const double depth = depth_of_skins(world, drawn) / size;
    ASSERT_FALSE(world.touches().empty());
    if (!counts) without = depth;
    if (!counts) continue;
    EXPECT_LT(depth, 2e-3);
    EXPECT_LT(depth, 0.4 * without);
    EXPECT_GT(depth, -6e-3);
  }
  EXPECT_GT(without, 3e-3);
}

}  // namespace skin_overhang_test
}  // namespace supple
