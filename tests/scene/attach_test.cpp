// Tests handles that go with a collider or with another body (`attach`).
#include <gtest/gtest.h>

#include <algorithm>

#include "geometry/triangles/surface_binding.h"
#include "scene/building/warnings.h"
#include "scene/definition/rotation.h"
#include "support/played_world.h"
#include "support/scene_text.h"

namespace supple {
namespace attach_test {

using test::scene_of;

// A bar whose left end is held, with further keys of the handle, and a cube.
std::string bar_and_cube(const std::string& handle) {
  return R"(substeps = 2
gravity = [0, 0, 0]
[[body]]
name = "bar"
box = { extent = [0.4, 0.1, 0.1], cells = [6, 2, 2] }
position = [0, 0.3, 0]
material = { model = "neo-hookean", mu = 10000, lambda = 20000 }
[[body.handles]]
name = "end"
select = { box = [[0, 0, 0], [0.01, 1, 1]] }
)" + handle +
         R"(
[[body]]
name = "cube"
box = { extent = [0.1, 0.1, 0.1], cells = [2, 2, 2] }
position = [-0.35, 0.3, 0]
spin_deg = [0, 0, 90]
material = { model = "neo-hookean", mu = 10000, lambda = 20000 }
)";
}
const std::string turning_stone = R"([[collider]]
name = "stone"
shape = { sphere = { radius = 0.05 } }
position = [-1, 0, 0]
keys = [{ t = 0 }, { t = 0.5, move = [0.1, 0.2, 0], turn_deg = [0, 0, 40] }]
)";

World played(const std::string& text, int frames) {
  const SceneDef scene = scene_of(text);
  World world(scene, assemble(scene));
  world.start({make_rule, settings_of}, nullptr);
  for (int frame = 0; frame < frames; ++frame) EXPECT_TRUE(world.play(frame));
  return world;
}

// Returns where the held vertices of the first body are, and where they are at rest.
std::pair<Positions, Positions> held_of(const World& world) {
  const Model& model = world.body(0).model();
  Positions now(std::ssize(model.handled), 3), rest = now;
  for (std::size_t i = 0; i < model.handled.size(); ++i) {
    now.row(Eigen::Index(i)) = world.body(0).state().x.row(model.handled[i].vertex);
    rest.row(Eigen::Index(i)) = model.rest.row(model.handled[i].vertex);
  }
  return {now, rest};
}

TEST(Attach, AHandleGoesWithAColliderAsARigidBody) {
  const World world = played(bar_and_cube("attach = { collider = \"stone\" }\n") + turning_stone, 15);
  const auto [now, rest] = held_of(world);
  const SceneCollider& stone = world.colliders().scene_colliders.front();
  const Eigen::Isometry3d motion = stone.pose(0.5) * stone.pose(0).inverse();
  ASSERT_GT(now.rows(), 4);
  for (Eigen::Index i = 0; i < now.rows(); ++i)
    EXPECT_LT((Vec3(now.row(i)) - motion * Vec3(rest.row(i))).norm(), 1e-12) << i;
  EXPECT_GT((now - rest).rowwise().norm().maxCoeff(), 0.2);
}

TEST(Attach, AHandleStaysBesideTheSurfaceOfAnotherBody) {
  const World world = played(bar_and_cube("attach = { body = \"cube\" }\n"), 20);
  const auto [now, rest] = held_of(world);
  EXPECT_GT((now - rest).rowwise().norm().maxCoeff(), 0.1);  // the cube turns by 60 degrees
  // The cube is free and hardly deformed, so that distances to its vertices stay as they are at rest.
  const State& cube = world.body(1).state();
  const Positions& at_rest = world.body(1).model().rest;
  for (Eigen::Index i = 0; i < now.rows(); ++i) {
    for (const Eigen::Index v : {0, 7, 20})
      EXPECT_NEAR((now.row(i) - cube.x.row(v)).norm(), (rest.row(i) - at_rest.row(v)).norm(), 2e-3) << i;
  }
}

TEST(Attach, LetsGoWhenItsTimeIsOver) {
  const std::string text =
      bar_and_cube("attach = { collider = \"stone\" }\nstiffness = 1e4\nuntil = 0.25\n") + turning_stone;
  const World held = played(text, 7), free = played(text, 15);
  const double before = (held_of(held).first - held_of(held).second).rowwise().norm().maxCoeff();
  EXPECT_GT(before, 0.05);
  EXPECT_EQ(free.body(0).state().anchors.holds.front(), 0);
  EXPECT_EQ(held.body(0).state().anchors.holds.front(), 1);
}

TEST(Attach, ARestoredWorldHasTheSameBits) {
  for (const char* what : {"attach = { body = \"cube\" }\n", "attach = { collider = \"stone\" }\n"}) {
    const std::string text = bar_and_cube(what) + turning_stone;
    const World whole = played(text, 12), half = played(text, 6);
    World other = played(text, 1);
    other.restore(half.state());
    for (int frame = 6; frame < 12; ++frame) ASSERT_TRUE(other.play(frame));
    EXPECT_EQ(other.hash(), whole.hash()) << what;
  }
}

TEST(Attach, RefusesWhatItCannotGoWith) {
  const auto message = [](const std::string& handle) {
    std::string all;
    for (const std::string& problem : test::problems_of(bar_and_cube(handle) + turning_stone)) all += problem + "\n";
    return all;
  };
  EXPECT_NE(message("attach = { collider = \"stne\" }\n").find("no collider is called 'stne'; did you mean 'stone'"),
            std::string::npos);
  EXPECT_NE(message("attach = { body = \"bar\" }\n").find("body 'bar' cannot hold itself"), std::string::npos);
  EXPECT_NE(message("attach = {}\n").find("either `collider` or `body`"), std::string::npos);
  EXPECT_NE(message("attach = { body = \"cube\", collider = \"stone\" }\n").find("either `collider` or `body`"),
            std::string::npos);
  EXPECT_NE(message("attach = { body = \"cube\" }\nkeys = [{ t = 0 }, { t = 1 }]\n").find("moves it"),
            std::string::npos);
  EXPECT_NE(message("attach = { body = \"cube\" }\nstiffness = 100\nfrom = 0.5\n").find("from the start"),
            std::string::npos);
}

TEST(SurfaceBinding, PointsTurnAndStretchWithTheirTriangles) {
  TriMesh surface;
  surface.points.resize(4, 3);
  surface.points << 0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0;
  surface.triangles.resize(2, 3);
  surface.triangles << 0, 1, 2, 1, 3, 2;
  Positions points(3, 3);
  points << 0.2, 0.3, 0.5, 0.9, 0.7, -0.1, 2, 2, 1;
  const SurfaceBinding binding(surface, points);
  EXPECT_LT((binding.points_at(surface.points) - points).cwiseAbs().maxCoeff(), 1e-15);
  const Mat3 turn = rotation_from_degrees(Vec3(20, -50, 130)).toRotationMatrix();
  const Eigen::RowVector3d move(1, -2, 3);
  const Positions turned = (surface.points * turn.transpose()).rowwise() + move;
  EXPECT_LT((binding.points_at(turned) - ((points * turn.transpose()).rowwise() + move)).cwiseAbs().maxCoeff(), 1e-14);
  // A surface that grows to twice its size moves the places on it apart, and keeps the heights above it.
  EXPECT_LT((binding.points_at(2 * surface.points).row(0) - Eigen::RowVector3d(0.4, 0.6, 0.5)).norm(), 1e-15);
}

TEST(Attach, ToABodyThatKeepsFastVibrationsIsWarnedOf) {
  const auto warned = [](const std::string& of_cube) {
    const SceneDef scene = scene_of(bar_and_cube("attach = { body = \"cube\" }") + of_cube);
    const std::vector<Problem> list = said(warnings(scene, assemble(scene)));
    return std::ranges::any_of(list, [](const Problem& problem) {
      return problem.message.starts_with("handle 'end' of body 'bar' will shake: it follows body 'cube'");
    });
  };
  EXPECT_FALSE(warned(""));
  EXPECT_TRUE(warned("solver = { integrator = \"implicit-midpoint\" }\n"));
}

}  // namespace attach_test
}  // namespace supple
