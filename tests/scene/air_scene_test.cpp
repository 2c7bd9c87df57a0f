// Tests air in scenes: what scenes and replays may say of it, that films with it have the same bits however they are
// made, and that its work is counted.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "geometry/meshes/mesh.h"
#include "scene/definition/air_of_body.h"
#include "scene/replay/script_trial.h"
#include "sim/air/enclosed_volume.h"
#include "sim/measures/energies.h"
#include "support/bodies.h"
#include "support/energy_watch.h"
#include "support/played_world.h"
#include "support/scene_text.h"
#include "support/surfaces.h"

namespace supple {
namespace air_scene_test {

const std::string flag = R"(substeps = 2
[[body]]
name = "flag"
cloth = { extent = [0.6, 0.4], cells = [18, 12], stretch = 300, bend = 0.5 }
density = 0.15
position = [0, 1, 0]
[[body.handles]]
name = "pole"
select = { box = [[0, 0, 0], [0.01, 1, 1]] }
)";
const std::string wind = "[wind]\nvelocity = [6, 0, 2]\ngusts = 0.3\n";
const std::string cube = R"([[body]]
name = "cube"
box = { extent = [0.2, 0.2, 0.2], cells = [3, 3, 3] }
position = [0.2, 1.5, 0]
material = { model = "neo-hookean", mu = 10000, lambda = 20000 }
)";

World world_of(const std::string& text) { return test::world_of(SceneSource("scene.toml", text)); }

std::vector<std::uint64_t> play(World& world, int frames) {
  std::vector<std::uint64_t> hashes;
  for (int i = 0; i < frames; ++i) {
    EXPECT_TRUE(world.play(world.frames()));
    hashes.push_back(world.hash());
  }
  return hashes;
}

void set(World& world, const std::string& path, const std::string& value, double over = 0) {
  TimedChange change{path, {}, 0, over, {}, {}, false, {}, {}, *ConfigValue::parse(value, "set"), {"set"}};
  world.change(std::move(change));
}

// Returns what assembling a scene refuses.
std::string refusal_of(const std::string& text) {
  try {
    (void)assemble(test::scene_of(text));
  } catch (const InputError& error) {
    EXPECT_EQ(error.problems().size(), 1u);
    return error.problems().front().text();
  }
  return "";
}

TEST(AirOfAScene, IsOnClothByDefaultAndOnSolidsThatAskForIt) {
  const SceneDef without = test::scene_of(flag + cube);
  for (const BodyDef& body : without.bodies) EXPECT_FALSE(air_of(without, body)) << body.name;
  const SceneDef scene = test::scene_of(flag + cube + "[body.pressure]\ngauge = -500\n" + cube.substr(0, 9) +
                                        "name = \"other\"\n" + cube.substr(23) + "drag = { normal = 2 }\n" + wind);
  ASSERT_EQ(scene.bodies.size(), 3u);
  EXPECT_EQ(scene.wind->velocity, Vec3(6, 0, 2));
  EXPECT_EQ(air_of(scene, scene.bodies[0])->drag.normal, usual_drag.normal);
  EXPECT_FALSE(air_of(scene, scene.bodies[1])->drag.act());
  EXPECT_EQ(air_of(scene, scene.bodies[1])->gas->gauge, -500);
  EXPECT_EQ(air_of(scene, scene.bodies[2])->drag.normal, 2);
  EXPECT_EQ(air_of(scene, scene.bodies[2])->drag.tangent, usual_drag.tangent);
  const SceneDef off = test::scene_of("seed = 7\n" + flag + wind);
  EXPECT_EQ(off.wind->seed, 7u);
}

TEST(AirOfAScene, IsOffWhereBothCoefficientsAreZero) {
  std::string text = flag;
  text.insert(text.find("density"), "drag = { normal = 0, tangent = 0 }\n");
  const SceneDef scene = test::scene_of(text + wind);
  EXPECT_FALSE(air_of(scene, scene.bodies[0]));
  World still = world_of(flag), windy = world_of(text + wind);
  EXPECT_EQ(play(still, 3), play(windy, 3));
}

TEST(AirOfAScene, IsRefusedInOneClearMessageWhereItIsWrong) {
  const auto only = [](const std::string& text) {
    const std::vector<std::string> problems = test::problems_of(text);
    EXPECT_EQ(problems.size(), 1u) << text;
    return problems.empty() ? "" : problems.front();
  };
  EXPECT_NE(only(flag + "[wind]\nspeed = 3\n").find("speed"), std::string::npos);
  EXPECT_NE(only(flag + "[wind]\nvelocity = 3\n").find("velocity = 3: must be a list of three numbers"),
            std::string::npos);
  EXPECT_NE(only(flag + "[wind]\ngusts = -1\n").find("gusts = -1: must be 0 to 10"), std::string::npos);
  EXPECT_NE(only(flag + "[wind]\ndensity = -1\n").find("density = -1"), std::string::npos);
  EXPECT_NE(only(cube + "drag = { normal = -1 }\n").find("normal = -1"), std::string::npos);
  EXPECT_NE(only(cube + "pressure = { gauge = -2e5 }\n").find("gauge"), std::string::npos);
  EXPECT_NE(only(cube + "pressure = { amount = \"some\" }\n").find("must be open or fixed"), std::string::npos);
}

TEST(AirOfAScene, RefusesAPressureInAnOpenSurface) {
  std::string text = flag;
  text.insert(text.find("density"), "pressure = { gauge = 100 }\n");
  EXPECT_EQ(refusal_of(text),
            "scene.toml:5:12: pressure of body 'flag': a pressure needs a closed surface, and its surface "
            "is not closed: 60 of its edges belong to an odd number of triangles");
  EXPECT_EQ(refusal_of(cube + "pressure = { gauge = 100 }\n"), "");
}

TEST(AirOfAScene, NotesADragThatHasNoAir) {
  const std::vector<Body> bodies = assemble(test::scene_of(cube + "drag = {}\n"));
  EXPECT_NE(
      std::ranges::find(bodies.front().notes, "body 'cube' has a drag, but the scene has no [wind] and so no air"),
      bodies.front().notes.end());
}

TEST(AirOfAScene, CarriesAFlagAway) {
  World world = world_of(flag + wind);
  play(world, 60);
  EXPECT_GT(world.body(0).state().x.col(2).mean(), 0.03);
  World still = world_of(flag);
  play(still, 60);
  EXPECT_LT(std::abs(still.body(0).state().x.col(2).mean()), 1e-6);
}

TEST(AirOfAScene, HasTheSameBitsAfterAReturnToAnEarlierState) {
  World world = world_of(flag + wind);
  play(world, 5);
  const WorldState state = world.state();
  const std::vector<std::uint64_t> first = play(world, 6);
  world.restore(state);
  EXPECT_EQ(play(world, 6), first);
  World again = world_of(flag + wind);
  again.restore(state);
  EXPECT_EQ(play(again, 6), first);
}

TEST(AirOfAScene, ChangesByReplaysAndLiveAlike) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path / "flag.toml") << flag << wind;
  std::ofstream(folder.path / "r.toml") << R"(scene = "flag.toml"
[[change]]
frame = 2
frames = 4
path = "wind.velocity"
value = [0, 0, -9]
[[change]]
frame = 3
path = "wind.gusts"
value = 0
[[change]]
frame = 4
path = "body.flag.drag.tangent"
value = 0.2
[[change]]
frame = 5
path = "wind.density"
value = 2
)";
  World replayed = test::world_of(folder.path / "r.toml");
  const std::vector<std::uint64_t> hashes = play(replayed, 12);
  World live = test::world_of(folder.path / "flag.toml"), plain = test::world_of(folder.path / "flag.toml");
  std::vector<std::uint64_t> by_hand = play(live, 2);
  const auto go_on = [&] { by_hand.push_back(play(live, 1).front()); };
  set(live, "wind.velocity", "[0, 0, -9]", 4 / 30.0);
  go_on();
  set(live, "wind.gusts", "0");
  go_on();
  set(live, "body.flag.drag.tangent", "0.2");
  go_on();
  set(live, "wind.density", "2");
  for (int i = 5; i < 12; ++i) go_on();
  EXPECT_EQ(by_hand, hashes);
  const std::vector<std::uint64_t> unchanged = play(plain, 12);
  EXPECT_EQ(unchanged[1], hashes[1]);
  EXPECT_NE(unchanged[2], hashes[2]);
}

TEST(AirOfAScene, BeginsWhereAReplaySaysSo) {
  World world = world_of(flag);
  play(world, 2);
  set(world, "wind.velocity", "[0, 0, 5]", 0.2);
  play(world, 20);
  EXPECT_GT(world.body(0).state().x.col(2).mean(), 0.01);
  EXPECT_THROW(set(world, "wind.gust_length", "2"), InputError);
  EXPECT_THROW(set(world, "body.flag.pressure.gauge", "2"), InputError);
}

TEST(AirOfAScene, IsTriedBeforeAReplayRuns) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path / "flag.toml") << flag;
  std::ofstream(folder.path / "r.toml") << R"(scene = "flag.toml"
[[change]]
frame = 5
path = "body.flag.pressure"
value = { gauge = 10 }
)";
  const Script script = Script::load(folder.path / "r.toml", test::assets, {});
  try {
    try_changes(script, assemble(script.scene()));
    FAIL();
  } catch (const InputError& error) {
    ASSERT_EQ(error.problems().size(), 1u);
    EXPECT_NE(error.problems().front().text().find("r.toml:5:"), std::string::npos);
    EXPECT_NE(error.problems().front().text().find("its surface is not closed"), std::string::npos);
  }
}

TEST(AirOfAScene, ListsItsLiveValues) {
  const Script script = Script::load(SceneSource("scene.toml", flag), test::assets, {});
  std::vector<std::string> paths;
  for (const LiveKey& key : script.live()) paths.push_back(key.key.path);
  for (const char* path : {"wind.velocity", "wind.gusts", "wind.density", "body.flag.drag.normal"})
    EXPECT_NE(std::ranges::find(paths, path), paths.end()) << path;
}

TEST(AirOfAScene, HasItsWorkCountedAsPutIn) {
  World world = world_of("solver = { iterations = 20 }\n" + flag + wind);
  double put_in = 0;
  EXPECT_LT(test::share_from_nothing(world, 100, put_in), 0.01);
  EXPECT_GT(put_in, 0.01);
}

// Writes a closed surface as the triangles of a MEDIT file.
void write_medit(const std::filesystem::path& path, const TriMesh& mesh) {
  std::ofstream file(path);
  file << "MeshVersionFormatted 1\nDimension 3\nVertices\n" << mesh.points.rows() << '\n';
  for (const auto& p : mesh.points.rowwise()) file << fmt::format("{} {} {} 0\n", p.x(), p.y(), p.z());
  file << "Triangles\n" << mesh.triangles.rows() << '\n';
  for (const auto& t : mesh.triangles.rowwise()) file << fmt::format("{} {} {} 0\n", t.x() + 1, t.y() + 1, t.z() + 1);
  file << "End\n";
}

double volume_of(const World& world, std::size_t body) {
  const Model& model = world.body(body).model();
  return std::abs(signed_volume(model.surface, 0, model.surface.rows(), world.body(body).state().x));
}

const std::string ball = R"(
cloth = { mesh = "ball.mesh", stretch = 800 }
density = 0.2
solver = { iterations = 20 }
)";

TEST(Balloon, IsInflatedByAReplayAndGainsNoEnergyFromNothing) {
  const test::TemporaryFolder folder;
  write_medit(folder.path / "ball.mesh", test::sphere_surface(0.15, 16, 9));
  for (const char* amount : {"open", "fixed"}) {
    std::ofstream(folder.path / "ball.toml")
        << "gravity = [0, 0, 0]\n[[body]]\nname = \"ball\"" << ball << "pressure = { amount = \"" << amount << "\" }\n";
    std::ofstream(folder.path / "r.toml") << R"(scene = "ball.toml"
[[change]]
t = 0
over = 2
path = "body.ball.pressure.gauge"
value = 3000
)";
    World world = test::world_of(folder.path / "r.toml");
    const double rest = volume_of(world, 0);
    double put_in = 0;
    EXPECT_LT(test::share_from_nothing(world, 90, put_in), 0.01) << amount;
    EXPECT_GT(volume_of(world, 0), 1.02 * rest) << amount;
    EXPECT_NE(put_in, 0) << amount;
  }
}

// A balloon falls onto another one, so that both make their steps as one island.
TEST(Balloon, KeepsItsVolumeWhereItMeetsAnother) {
  const test::TemporaryFolder folder;
  write_medit(folder.path / "ball.mesh", test::sphere_surface(0.15, 16, 9));
  std::ofstream(folder.path / "two.toml")
      << "[[body]]\nname = \"low\"" << ball << "pressure = { gauge = 1500, amount = \"fixed\" }\n"
      << "[[body]]\nname = \"high\"" << ball << "position = [0.03, 0.4, 0]\n"
      << "pressure = { gauge = 1500, amount = \"fixed\" }\n"
      << "[[collider]]\nshape = { half_space = { normal = [0, 1, 0] } }\n"
      << "[wind]\nvelocity = [0.5, 0, 0]\n";
  World world = test::world_of(folder.path / "two.toml");
  const double rest = volume_of(world, 0);
  bool together = false;
  double put_in = 0;
  EXPECT_LT(test::share_from_nothing(world, 5, put_in), 0.01);
  for (int i = 5; i < 40; ++i) {
    ASSERT_TRUE(world.play(i));
    together |= world.body(0).is_in_island();
  }
  EXPECT_TRUE(together);
  EXPECT_GT(volume_of(world, 0), 0.97 * rest);
  EXPECT_GT(volume_of(world, 1), 0.97 * rest);
  EXPECT_LT(volume_of(world, 0), 1.2 * rest);
}

}  // namespace air_scene_test
}  // namespace supple
