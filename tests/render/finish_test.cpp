// Tests how surfaces treat light besides their colour: how rough they are, and what they let through.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "render/renderer.h"
#include "support/places.h"

namespace supple {
namespace finish_test {

constexpr int width = 240, height = 160;

int brightness(const Image& image, int x, int y) {
  const std::size_t at = 3 * (std::size_t(y) * width + std::size_t(x));
  return image.rgb[at] + image.rgb[at + 1] + image.rgb[at + 2];
}

// Calls visit(x, y) for the pixels around the middle, without the outline of a ball there, where all reflect much.
template <class Visit>
void around_middle(const Visit& visit) {
  constexpr int radius = 34;  // pixels, of the ball's 52
  for (int y = -radius; y <= radius; ++y)
    for (int x = -radius; x <= radius; ++x)
      if (x * x + y * y <= radius * radius) visit(width / 2 + x, height / 2 + y);
}

int brightest(const Image& image) {
  int most = 0;
  around_middle([&](int x, int y) { most = std::max(most, brightness(image, x, y)); });
  return most;
}

// Returns the number of pixels that are brighter than in another picture by more than some levels.
int brighter(const Image& image, const Image& other, int levels) {
  int count = 0;
  around_middle([&](int x, int y) { count += brightness(image, x, y) > brightness(other, x, y) + levels ? 1 : 0; });
  return count;
}

// A mesh and where it is.
struct Placed {
  DrawMesh mesh;
  std::vector<float> points;
};

void finish_mesh(Placed& placed, const Vec3& color) {
  DrawMesh& mesh = placed.mesh;
  mesh.occlusion.assign(placed.points.size() / 3, 1);
  mesh.paint.resize(placed.points.size() / 3);
  for (auto& layers : mesh.paint) layers.fill(1e3f);
  mesh.color = color;
  mesh.gloss = 0;
  for (std::size_t i = 0; i < placed.points.size(); i += 3)
    mesh.rest.include(Vec3(placed.points[i], placed.points[i + 1], placed.points[i + 2]));
}

// Makes a ball of squares along circles of latitude.
Placed ball(const Vec3& center, double radius, const Vec3& color) {
  constexpr unsigned around = 96, down = 48;
  Placed ball;
  for (unsigned i = 0; i <= down; ++i) {
    for (unsigned j = 0; j < around; ++j) {
      const double polar = std::numbers::pi * i / down, turn = 2 * std::numbers::pi * j / around;
      const Vec3 out(std::sin(polar) * std::cos(turn), std::cos(polar), -std::sin(polar) * std::sin(turn));
      for (int k = 0; k < 3; ++k) ball.points.push_back(static_cast<float>(center[k] + radius * out[k]));
    }
  }
  for (unsigned i = 0; i < down; ++i) {
    for (unsigned j = 0; j < around; ++j) {
      const unsigned a = i * around + j, b = i * around + (j + 1) % around;
      ball.mesh.triangles.insert(ball.mesh.triangles.end(), {a, a + around, b + around, a, b + around, b});
    }
  }
  finish_mesh(ball, color);
  return ball;
}

// Makes an upright slab that is a metre wide and high, and whose front is at z = 0.
Placed slab(double thick, const Vec3& color) {
  Placed slab;
  const auto depth = static_cast<float>(-thick);
  for (const float z : {0.0f, depth}) {
    for (const auto& [x, y] : {std::array{-0.5f, 0.5f}, {0.5f, 0.5f}, {0.5f, 1.5f}, {-0.5f, 1.5f}})
      slab.points.insert(slab.points.end(), {x, y, z});
  }
  slab.mesh.triangles = {0, 1, 2, 0, 2, 3, 5, 4, 7, 5, 7, 6, 1, 5, 6, 1, 6, 2,
                         4, 0, 3, 4, 3, 7, 3, 2, 6, 3, 6, 7, 4, 5, 1, 4, 1, 0};
  finish_mesh(slab, color);
  return slab;
}

// Draws meshes, seen along z from this distance on the side of positive z. light: towards the key.
Image draw(const std::vector<Placed>& placed, const Vec3& light = studio_light().to_key) {
  Stage stage;
  stage.width = width;
  stage.height = height;
  stage.backdrop = Backdrop::plain;
  stage.colors.background = Vec3::Zero();
  stage.light.to_key = light;
  DrawList list;
  list.camera = stage.first_camera = {Vec3(0, 1, 4), Vec3(0, 1, 0), 26};
  for (const Placed& one : placed) {
    stage.meshes.push_back(one.mesh);
    list.positions.push_back(one.points);
  }
  Renderer renderer(stage, GlChoice::osmesa, test::source_folder / "shaders");
  return renderer.draw(list);
}

Placed with(Placed placed, const Finish& finish) {
  placed.mesh.finish = finish;
  return placed;
}

const Vec3 brown(0.45, 0.25, 0.12);
const Vec3 from_behind(-0.2, 0.5, -1);

TEST(Finish, AHighlightIsSmallAndBrightOnWetThingsAndGoneOnChalk) {
  const Placed matt = ball(Vec3(0, 1, 0), 0.6, brown);
  const Image bare = draw({matt}), wet = draw({with(matt, {0.0, 0})}), satin = draw({with(matt, {0.45, 0})}),
              chalk = draw({with(matt, {1.0, 0})});
  EXPECT_GT(brightest(wet), brightest(satin) + 60);
  EXPECT_GT(brightest(satin), brightest(chalk) + 20);
  EXPECT_LT(brightest(chalk), brightest(bare) + 60);
  EXPECT_GT(brighter(wet, bare, 200), 10) << "the lamp is seen in it";
  EXPECT_LT(brighter(wet, bare, 200), 34 * 34 / 4);
}

TEST(Finish, RoughnessSpreadsAHighlight) {
  const Placed matt = ball(Vec3(0, 1, 0), 0.6, brown);
  const Image chalk = draw({with(matt, {1.0, 0})});
  int before = 0;
  for (const double roughness : {0.0, 0.2, 0.4}) {
    const int pixels = brighter(draw({with(matt, {roughness, 0})}), chalk, 30);
    EXPECT_GT(pixels, before) << roughness;
    before = pixels;
  }
}

TEST(Finish, OtherSurfacesKeepTheirBytes) {
  const Placed left = ball(Vec3(-0.7, 1, 0), 0.4, brown), right = ball(Vec3(0.7, 1, 0), 0.4, brown);
  const Image plain = draw({left, right}), changed = draw({left, with(right, {0.1, 0.6})});
  EXPECT_NE(plain.rgb, changed.rgb);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width / 2; ++x) ASSERT_EQ(brightness(plain, x, y), brightness(changed, x, y)) << x << ' ' << y;
}

// The lower half of the ball is painted.
TEST(Finish, PaintKeepsAGlossThatIsAboveTheRoughness) {
  const auto painted = [](double gloss, std::optional<double> roughness) {
    Placed one = ball(Vec3(0, 1, 0), 0.6, brown);
    one.mesh.layers = {{brown, gloss, 0.001}};
    for (std::size_t v = 0; v < one.mesh.paint.size(); ++v) one.mesh.paint[v][0] = one.points[3 * v + 1] - 1;
    one.mesh.finish.roughness = roughness;
    return draw({one});
  };
  const auto lower_half_differs = [](const Image& a, const Image& b) {
    int count = 0;
    for (int y = height / 2 + 6; y < height; ++y)
      for (int x = 0; x < width; ++x) count += brightness(a, x, y) != brightness(b, x, y) ? 1 : 0;
    return count;
  };
  EXPECT_EQ(lower_half_differs(painted(0.9, std::nullopt), painted(0.9, 1.0)), 0) << "eyes shine in a face of chalk";
  EXPECT_GT(lower_half_differs(painted(0.2, std::nullopt), painted(0.2, 0.05)), 500) << "a wet face is wet all over";
}

TEST(Finish, ThinPartsLetLightThroughAndThickOnesDoNot) {
  const auto glow = [](double thick, double translucent) {
    const Placed one = slab(thick, Vec3(0.8, 0.2, 0.15));
    return brightness(draw({with(one, {{}, translucent})}, from_behind), width / 2, height / 2) -
           brightness(draw({one}, from_behind), width / 2, height / 2);
  };
  EXPECT_GT(glow(0.03, 0.5), 60);
  EXPECT_GT(glow(0.03, 0.9), glow(0.03, 0.3) + 20);
  EXPECT_GT(glow(0.03, 0.5), glow(0.15, 0.5) + 20);
  EXPECT_LT(glow(1.5, 0.3), 6);
}

TEST(Finish, WhatFacesTheLampDoesNotGlow) {
  const Placed one = slab(0.03, Vec3(0.8, 0.2, 0.15));
  const Vec3 from_front(-0.2, 0.5, 1);
  const Image plain = draw({one}, from_front), through = draw({with(one, {{}, 0.8})}, from_front);
  const int change = brightness(through, width / 2, height / 2) - brightness(plain, width / 2, height / 2);
  EXPECT_GE(change, 0);
  // The rim light, which is behind, comes through.
  const Image from_back = draw({with(one, {{}, 0.8})}, from_behind), back = draw({one}, from_behind);
  EXPECT_LT(change, brightness(from_back, width / 2, height / 2) - brightness(back, width / 2, height / 2) - 30);
}

TEST(Finish, AThingBetweenLampAndSheetCastsItsShadowOntoTheOtherSide) {
  Placed sheet;
  sheet.points = {-0.7f, 0.3f, 0, 0.7f, 0.3f, 0, 0.7f, 1.7f, 0, -0.7f, 1.7f, 0};
  sheet.mesh.triangles = {0, 1, 2, 0, 2, 3};
  finish_mesh(sheet, Vec3(0.8, 0.15, 0.1));
  sheet.mesh.flat.assign(4, {0, 0, 1});
  sheet.mesh.two_sided = true;
  sheet.mesh.cloth = ClothLook{Vec3(0.8, 0.15, 0.1), 0, 0};
  const Vec3 straight_behind(0, 0.05, -1);
  const Placed thing = ball(Vec3(0, 1, -0.6), 0.2, brown);
  const Image dull = draw({sheet, thing}, straight_behind),
              lit = draw({with(sheet, {{}, 0.8}), thing}, straight_behind);
  const auto glow = [&](int x) { return brightness(lit, x, height / 2) - brightness(dull, x, height / 2); };
  EXPECT_GT(glow(width / 2 + 45), 60);
  EXPECT_LT(glow(width / 2), glow(width / 2 + 45) / 2) << "only the rim light comes here";
  const std::size_t at = 3 * (std::size_t(height / 2) * width + width / 2 + 45);
  EXPECT_GT(lit.rgb[at] - dull.rgb[at], 2 * (lit.rgb[at + 2] - dull.rgb[at + 2]))
      << "a red cloth lets red light through";
}

}  // namespace finish_test
}  // namespace supple
