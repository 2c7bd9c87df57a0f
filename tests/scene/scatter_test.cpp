// Tests [[scatter]], which makes many bodies of a few, and bodies that spin at the start.
#include <gtest/gtest.h>

#include <fmt/core.h>

#include <algorithm>
#include <numbers>

#include "scene/building/assemble.h"
#include "scene/definition/rotation.h"
#include "support/played_world.h"
#include "support/scene_text.h"

namespace supple {
namespace scatter_test {

using test::scene_of;

const std::string boxes = R"([[body]]
name = "cube"
box = { extent = [0.1, 0.1, 0.1], cells = [1, 1, 1] }
material = { model = "neo-hookean", mu = 10000, lambda = 20000 }
turn_deg = [90, 0, 0]
[[body]]
name = "brick"
box = { extent = [0.2, 0.1, 0.1], cells = [2, 1, 1] }
material = { model = "neo-hookean", mu = 10000, lambda = 20000 }
size = 0.3
)";

std::string scattered(const std::string& keys) {
  return boxes + "[[scatter]]\nbodies = [\"cube\", \"brick\"]\ncount = 21\nbox = [[-1, 0, -2], [1, 0.5, 2]]\n" + keys;
}

// Returns how the z axis of a body's own frame is turned.
Vec3 third_axis(const BodyDef& body) { return rotation_from_degrees(body.turn_deg) * Vec3::UnitZ(); }

TEST(Scatter, MakesCopiesInTurnInsideItsBoxAndApart) {
  const SceneDef scene = scene_of(scattered("sizes = [0.5, 2]\n"));
  ASSERT_EQ(scene.bodies.size(), 21u);
  EXPECT_EQ(std::ranges::count_if(scene.bodies, [](const BodyDef& b) { return b.table == "cube"; }), 11);
  EXPECT_EQ(scene.bodies.front().name, "cube_1");
  EXPECT_EQ(scene.bodies.back().name, "brick_10");
  double nearest = 1e9, least = 1e9, most = 0;
  for (const BodyDef& body : scene.bodies) {
    EXPECT_LE(std::abs(body.position.x()), 1);
    EXPECT_LE(std::abs(body.position.z()), 2);
    EXPECT_GE(body.position.y(), 0);
    EXPECT_LE(body.position.y(), 0.5);
    EXPECT_EQ(body.label, "");
    const double factor = body.size ? *body.size / 0.3 : body.scale;
    least = std::min(least, factor);
    most = std::max(most, factor);
    for (const BodyDef& other : scene.bodies) {
      if (&other != &body) nearest = std::min(nearest, (other.position - body.position).norm());
    }
  }
  EXPECT_GE(least, 0.5);
  EXPECT_LT(least, 0.8);
  EXPECT_LE(most, 2);
  EXPECT_GT(most, 1.6);
  EXPECT_GT(nearest, 0.25);  // 0.06 on average where each place is random by itself
}

TEST(Scatter, TurnsAfterTheBodysOwnTurn) {
  // The cube's third axis points down after its own turn; a turn about the vertical leaves it there.
  double change = 0, first_heading = 0;
  for (const BodyDef& body : scene_of(scattered("")).bodies) {
    if (body.table != "cube") continue;
    EXPECT_NEAR(third_axis(body).y(), -1, 1e-9);
    const Vec3 x = rotation_from_degrees(body.turn_deg) * Vec3::UnitX();
    const double heading = std::atan2(x.z(), x.x());
    if (body.name == "cube_1") first_heading = heading;
    change = std::max(change, std::abs(heading - first_heading));
  }
  EXPECT_GT(change, 1);
  double up = 0;
  for (const BodyDef& body : scene_of(scattered("turn = \"any\"\n")).bodies) up = std::max(up, third_axis(body).y());
  EXPECT_GT(up, 0.5);
  for (const BodyDef& body : scene_of(scattered("turn = \"none\"\n")).bodies)
    EXPECT_NEAR((body.turn_deg - Vec3(body.table == "cube" ? 90 : 0, 0, 0)).norm(), 0, 1e-9);
}

TEST(Scatter, IsTheSameForTheSameSeedsAlone) {
  const auto first = [](const std::string& keys) { return scene_of(scattered(keys)).bodies.front().position; };
  EXPECT_EQ(first(""), first(""));
  EXPECT_NE(first(""), first("seed = 2\n"));
  EXPECT_NE(first(""), scene_of("seed = 7\n" + scattered("")).bodies.front().position);
}

// The copies' tables are those of their bodies, so that one setting is that of all of them.
TEST(Scatter, CopiesShareThePathsOfTheirBody) {
  const World world = test::world_of(SceneSource("scene.toml", scattered("")), {"body.cube.density=77"});
  for (const BodyDef& body : world.scene().bodies) EXPECT_EQ(body.density.value_or(0), body.table == "cube" ? 77 : 0);
}

TEST(Scatter, RefusesWhatItCannotDo) {
  const auto refused = [](const std::string& text, const std::string& words) {
    const std::vector<std::string> problems = test::problems_of(text);
    EXPECT_TRUE(std::ranges::any_of(problems, [&](const std::string& p) { return p.find(words) != p.npos; }))
        << words << " is not in " << (problems.empty() ? "nothing" : problems.front());
  };
  const std::string head = boxes + "[[scatter]]\n";
  refused(head + "bodies = [\"cubes\"]\ncount = 2\nbox = [[0, 0, 0], [1, 1, 1]]\n", "did you mean 'cube'");
  refused(head + "bodies = []\ncount = 2\nbox = [[0, 0, 0], [1, 1, 1]]\n", "bodies");
  refused(head + "count = 2\nbox = [[0, 0, 0], [1, 1, 1]]\n", "'bodies' is missing");
  refused(head + "bodies = [\"cube\"]\ncount = 301\nbox = [[0, 0, 0], [1, 1, 1]]\n", "count");
  refused(head + "bodies = [\"cube\"]\ncount = 2\nbox = [[0, 2, 0], [1, 1, 1]]\n", "the first corner");
  refused(scattered("sizes = [2, 1]\n"), "the smaller one");
  refused(
      "[[body]]\nname = \"a\"\nbox = { extent = [1, 1, 1], cells = [1, 1, 1] }\nmaterial = \"jelly\"\n"
      "position = [0, 1, 0]\n[[scatter]]\nbodies = [\"a\"]\ncount = 2\nbox = [[0, 0, 0], [1, 1, 1]]\n",
      "places of their own");
}

TEST(Spin, TurnsAboutTheCentreOfMass) {
  const SceneDef scene = scene_of(
      "[[body]]\nbox = { extent = [0.2, 0.1, 0.3], cells = [2, 1, 2] }\nmaterial = \"jelly\"\n"
      "velocity = [1, 0, 0]\nspin_deg = [0, 180, 0]\n");
  const std::vector<Body> bodies = assemble(scene);
  const Model model = build_model(bodies[0].description);
  const State state = start_state(model, bodies[0]);
  Vec3 momentum = Vec3::Zero(), center = Vec3::Zero();
  double mass = 0;
  for (int v = 0; v < model.vertices; ++v) {
    mass += model.mass[v];
    momentum += model.mass[v] * state.v.row(v).transpose();
    center += model.mass[v] * state.x.row(v).transpose();
  }
  EXPECT_LT((momentum / mass - Vec3(1, 0, 0)).norm(), 1e-12);
  const Vec3 spin(0, std::numbers::pi, 0);
  for (int v = 0; v < model.vertices; ++v) {
    const Vec3 expected = Vec3(1, 0, 0) + spin.cross(Vec3(state.x.row(v).transpose()) - center / mass);
    EXPECT_LT((Vec3(state.v.row(v).transpose()) - expected).norm(), 1e-12);
  }
}

}  // namespace scatter_test
}  // namespace supple
