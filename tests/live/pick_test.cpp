// Tests what a pointer finds: the body in front, the place on its surface, and vertices around it.
#include <gtest/gtest.h>

#include "live/pick.h"
#include "support/played_world.h"

namespace supple {
namespace pick_test {

const std::string two_cubes = R"(gravity = [0, 0, 0]
[[body]]
name = "near"
box = { extent = [0.2, 0.2, 0.2], cells = [4, 4, 4] }
position = [0, -0.1, 1]
material = { model = "neo-hookean", mu = 1e4, lambda = 2e4 }
[[body]]
name = "far"
box = { extent = [1, 1, 0.2], cells = [4, 4, 2] }
position = [0, -0.5, -1]
material = { model = "neo-hookean", mu = 1e9, lambda = 2e9 }
)";
constexpr double aspect = 2;
const Camera camera{Vec3(0, 0, 3), Vec3(0, 0, 0), 30};

class Picking : public testing::Test {
 protected:
  World world_ = test::world_of(SceneSource("scene.toml", two_cubes));
};

TEST_F(Picking, FindsTheBodyInFront) {
  const auto middle = pick(world_, camera, aspect, {0.5, 0.5});
  ASSERT_TRUE(middle);
  EXPECT_EQ(middle->body, 0u);
  EXPECT_TRUE(middle->place.isApprox(Vec3(0, 0, 1.1), 1e-6)) << middle->place;
  const auto above = pick(world_, camera, aspect, {0.5, 0.3});
  ASSERT_TRUE(above);
  EXPECT_EQ(above->body, 1u);
  EXPECT_NEAR(above->place.z(), -0.9, 1e-6);
  EXPECT_GT(above->place.y(), 0.1);
  EXPECT_FALSE(pick(world_, camera, aspect, {0.02, 0.02}));
}

TEST_F(Picking, FindsABodyJustBesideThePointer) {
  // The near cube's right edge is 0.1 m from the middle at a distance of 1.9 m.
  const double right = 0.5 + 0.1 / (2 * std::tan(15 * M_PI / 180) * 1.9 * aspect);
  World alone = test::world_of(SceneSource("scene.toml", two_cubes.substr(0, two_cubes.rfind("[[body]]"))));
  EXPECT_TRUE(pick(alone, camera, aspect, {right - 0.005, 0.5}));
  EXPECT_TRUE(pick(alone, camera, aspect, {right + 0.005, 0.5}));
  EXPECT_FALSE(pick(alone, camera, aspect, {right + 0.03, 0.5}));
}

TEST_F(Picking, TakesVerticesAroundThePlace) {
  const auto middle = pick(world_, camera, aspect, {0.5, 0.5});
  ASSERT_TRUE(middle);
  const Positions& rest = world_.bodies()[0].description.mesh.rest;
  ASSERT_FALSE(middle->vertices.empty());
  for (const int v : middle->vertices) EXPECT_LT((rest.row(v - 1).transpose() - middle->place).norm(), 0.03) << v;
}

TEST_F(Picking, StiffBodiesAreNotPulledApart) {
  const auto soft = pick(world_, camera, aspect, {0.5, 0.5}), stiff = pick(world_, camera, aspect, {0.5, 0.3});
  const double weight = world_.body(1).model().total_mass * 9.81, size = world_.body(1).model().size;
  EXPECT_NEAR(stiff->stiffness * double(stiff->vertices.size()), 50 * weight / size, 1e-6 * weight / size);
  EXPECT_GT(soft->stiffness, 0);
}

TEST(PickPlane, IsParallelToThePicture) {
  const Vec3 point(0.1, 0.2, 1);
  const Vec3 there = point_in_plane(camera, aspect, {0.5, 0.5}, point);
  EXPECT_TRUE(there.isApprox(Vec3(0, 0, 1), 1e-5)) << there;
  const Vec3 top = point_in_plane(camera, aspect, {0.5, 0}, point);
  EXPECT_NEAR(2 * top.y(), picture_height_at(camera, point), 1e-5);
}

}  // namespace pick_test
}  // namespace supple
