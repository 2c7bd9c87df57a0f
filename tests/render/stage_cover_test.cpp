// Tests what lights, shadows and the ground cover as bodies move.
#include "render/stage_cover.h"

#include <gtest/gtest.h>

#include "support/places.h"

namespace supple {
namespace stage_cover_test {

constexpr double edge = 0.2;  // of a cube that stands on the ground [m]
const Vec3 to_light = Vec3(-0.4, 1, 0.5).normalized();

std::vector<float> cube_at(const Vec3& foot) {
  std::vector<float> points;
  for (int corner = 0; corner < 8; ++corner) {
    for (int k = 0; k < 3; ++k)
      points.push_back(static_cast<float>(foot[k] + edge * ((corner >> k & 1) - (k == 1 ? 0.0 : 0.5))));
  }
  return points;
}

Stage stage_with(int cubes) {
  Stage stage;
  for (int c = 0; c < cubes; ++c) {
    DrawMesh mesh;
    mesh.rest.lower = Vec3(c - edge / 2, 0, -edge / 2);
    mesh.rest.upper = Vec3(c + edge / 2, edge, edge / 2);
    stage.meshes.push_back(mesh);
  }
  return stage;
}

// Returns the frame in which a camera looks at the first cube.
DrawList list_with(const std::vector<Vec3>& feet) {
  DrawList list;
  for (const Vec3& foot : feet) list.positions.push_back(cube_at(foot));
  list.camera.target = feet.front();
  list.camera.eye = feet.front() + Vec3(0, 1, 2);
  return list;
}

bool lies_in_shadow_map(const StageCover::Frame& frame, const Vec3& point) {
  return (point - frame.shadow_center).norm() + edge < std::sqrt(3) * frame.shadow_radius;
}

bool is_same(const StageCover::Frame& a, const StageCover::Frame& b) {
  return a.light_center == b.light_center && a.light_radius == b.light_radius && a.shadow_center == b.shadow_center &&
         a.shadow_radius == b.shadow_radius && a.shade_center == b.shade_center && a.shade_extent == b.shade_extent;
}

TEST(StageCover, StaysAsLongAsNothingLeavesTheStage) {
  const Stage stage = stage_with(2);
  const StageCover cover(stage, to_light);
  EXPECT_TRUE(is_same(cover.at(stage.meshes, list_with({{0, 0, 0}, {1, 0, 0}})), cover.at_rest()));
  EXPECT_TRUE(is_same(cover.at(stage.meshes, list_with({{0.1, 0.1, 0}, {0.9, 0, 0.1}})), cover.at_rest()));
}

TEST(StageCover, FollowsWhatLeaves) {
  const Stage stage = stage_with(1);
  const StageCover cover(stage, to_light);
  for (const Vec3& foot : {Vec3(3, 0, 0), Vec3(-40, 0, 7), Vec3(0, 0, -900), Vec3(1.234, 2.5, 0.7)}) {
    const StageCover::Frame frame = cover.at(stage.meshes, list_with({foot}));
    EXPECT_TRUE(lies_in_shadow_map(frame, foot)) << foot.transpose();
    EXPECT_EQ(frame.shadow_radius, cover.at_rest().shadow_radius) << "one body needs no larger map";
    if (foot.y() > edge) continue;  // it hides no sky from the ground
    EXPECT_LT((foot - frame.shade_center).cwiseAbs().maxCoeff() + edge / 2, frame.shade_extent / 2);
  }
}

// Texels of the shadow map stay on one grid, so that shadows do not shimmer.
TEST(StageCover, MovesTheShadowMapByWholeTexels) {
  const Stage stage = stage_with(1);
  const StageCover cover(stage, to_light);
  const Vec3 right = to_light.cross(Vec3::UnitY()).normalized(), up = right.cross(to_light);
  const double texel = cover.at_rest().shadow_radius * 2 / 512;
  for (double x = 1; x < 4; x += 0.037) {
    const StageCover::Frame frame = cover.at(stage.meshes, list_with({{x, 0, 0.3 * x}}));
    const Vec3 moved = frame.shadow_center - cover.at_rest().shadow_center;
    for (const Vec3& axis : {right, up}) EXPECT_NEAR(std::remainder(moved.dot(axis), texel), 0, 1e-4 * texel) << x;
  }
}

// The light moves without jumps, for a camera that stands and for one that follows.
TEST(StageCover, MovesTheLightSmoothly) {
  const Stage stage = stage_with(2);
  const StageCover cover(stage, to_light);
  constexpr double step = 0.01;
  for (const bool followed : {false, true}) {
    StageCover::Frame last = cover.at_rest();
    for (double x = 0; x < 8; x += step) {
      DrawList list = list_with({{x, 0, 0}, {1, 0, 0}});
      if (followed) list.followed = Followed{0, Vec3(x, 0, 0)};
      const StageCover::Frame frame = cover.at(stage.meshes, list);
      EXPECT_LT((frame.light_center - last.light_center).norm(), 1.01 * step + 1e-6) << x;
      EXPECT_LT(std::abs(frame.light_radius - last.light_radius), 1.01 * step + 1e-6) << x;
      EXPECT_LT((frame.light_center - Vec3(x, 0, 0)).norm(), frame.light_radius) << x;
      last = frame;
    }
  }
}

// What the picture does not show needs no shadow, and does not make those of the rest coarse.
// The middle of the light is that of the body, so that there is no way in which it would have to move.
TEST(StageCover, HoldsABodyThatGrowsAroundTheLight) {
  const Stage stage = stage_with(1);
  const StageCover cover(stage, to_light);
  DrawList list = list_with({{0, 0, 0}});
  list.camera.eye = Vec3(0, 10, 20);
  for (float& value : list.positions[0]) value *= 12;
  const StageCover::Frame frame = cover.at(stage.meshes, list);
  EXPECT_EQ(frame.light_center, cover.at_rest().light_center);
  EXPECT_GT(frame.light_radius, cover.at_rest().light_radius);
  EXPECT_GE(frame.light_radius, 0.5 * 12 * edge);
}

TEST(StageCover, LeavesOutWhatIsNotSeen) {
  const Stage stage = stage_with(2);
  const StageCover cover(stage, to_light);
  const StageCover::Frame frame = cover.at(stage.meshes, list_with({{0, 0, 0}, {0, 0, 50}}));
  EXPECT_EQ(frame.shadow_radius, cover.at_rest().shadow_radius);
  EXPECT_EQ(frame.shadow_center, cover.at_rest().shadow_center);
}

}  // namespace stage_cover_test
}  // namespace supple
