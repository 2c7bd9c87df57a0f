// Tests scenes with bodies that keep dents or creep: the same bits come out whatever the threads are, wherever a film
// is resumed, and by a replay that changes them; bodies that fall on each other flow, too; and what cannot be is
// refused.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <fstream>

#include "film/record/checkpoint.h"
#include "sim/measures/measures.h"
#include "support/bodies.h"
#include "support/played_world.h"
#include "support/scene_text.h"
#include "world/world.h"

namespace supple {
namespace flow_world_test {

// Two cubes that fall on each other and on a post. The lower one keeps dents, the upper one creeps.
const std::string cubes = R"(fps = 60
[[body]]
name = "tin"
box = { extent = [0.2, 0.2, 0.2], cells = [4, 4, 4] }
position = [0, 0.12, 0]
velocity = [0, -3, 0]
material = { model = "neo-hookean", young = 2e5, poisson = 0.3 }
plastic = { yield = 4e3, hardening = 2e4 }
creep = { share = 0.2, time = 0.2 }
[[body]]
name = "jelly"
box = { extent = [0.2, 0.2, 0.2], cells = [3, 3, 3] }
position = [0.03, 0.35, 0]
velocity = [0, -3, 0]
material = { model = "stable-neo-hookean", young = 5e4, poisson = 0.4 }
creep = { share = 0.8, time = 0.1 }
[[collider]]
name = "post"
shape = { box = { extent = [0.06, 0.1, 0.06] } }
position = [0, 0.05, 0]
[[collider]]
name = "ground"
shape = { half_space = { normal = [0, 1, 0] } }
)";

const std::string softer = R"(scene = "cubes.toml"
[[change]]
frame = 8
path = "body.tin.plastic.yield"
value = 1e3
[[change]]
frame = 14
path = "body.jelly.creep.share"
value = 0.5
[[change]]
frame = 16
path = "body.jelly.creep.time"
value = 1
)";

World world_of(const SceneSource& source, Threads& threads) {
  Script script = Script::load(source, test::assets, {});
  std::vector<Body> bodies = assemble(script.scene());
  World world(std::move(script), std::move(bodies));
  world.start({make_rule, settings_of}, &threads);
  return world;
}

class FlowScene : public testing::Test {
 protected:
  void SetUp() override {
    std::ofstream(folder_.path / "cubes.toml") << cubes;
    std::ofstream(folder_.path / "softer.toml") << softer;
  }
  std::vector<std::uint64_t> play(World& world, int end) {
    std::vector<std::uint64_t> hashes;
    while (world.frames() < end) {
      EXPECT_TRUE(world.play(world.frames()));
      hashes.push_back(world.hash());
    }
    return hashes;
  }
  test::TemporaryFolder folder_;
};

TEST_F(FlowScene, BitsDependNeitherOnThreadsNorOnWhereAFilmWasResumed) {
  for (const char* file : {"cubes.toml", "softer.toml"}) {
    Threads one(1);
    World first = world_of(folder_.path / file, one);
    std::vector<std::uint64_t> hashes = play(first, 13);
    const std::string kept = checkpoint_bytes(first.state(), "{}");
    const WorldState middle = first.state();
    EXPECT_GT(middle.bodies[0].flow.lost, 0);
    EXPECT_GT(middle.bodies[1].flow.lost, 0);
    const std::vector<std::uint64_t> rest = play(first, 24);
    hashes.insert(hashes.end(), rest.begin(), rest.end());
    EXPECT_TRUE(first.body(0).is_in_island()) << "the cubes touch";
    for (const int count : {2, 4}) {
      Threads threads(count);
      World other = world_of(folder_.path / file, threads);
      EXPECT_EQ(play(other, 24), hashes) << file << ", " << count << " threads";
    }
    std::ofstream(folder_.path / "checkpoint", std::ios::binary) << kept;
    World resumed = world_of(folder_.path / file, one);
    resumed.restore(read_checkpoint(folder_.path / "checkpoint", "{}"));
    EXPECT_EQ(play(resumed, 24), rest) << file;
    first.restore(middle);  // back, in a world that has gone further
    EXPECT_EQ(play(first, 24), rest) << file;
  }
}

TEST_F(FlowScene, AReplayChangesWhatFlows) {
  Threads threads(1);
  World plain = world_of(folder_.path / "cubes.toml", threads),
        changed = world_of(folder_.path / "softer.toml", threads);
  EXPECT_EQ(play(plain, 8), play(changed, 8));
  play(plain, 20);
  play(changed, 20);
  EXPECT_NE(plain.hash(), changed.hash());
  const auto kept = [](const World& world) {
    const std::vector<double>& list = world.body(0).state().flow.hardened;
    return *std::max_element(list.begin(), list.end());
  };
  EXPECT_GT(kept(changed), kept(plain));
}

TEST_F(FlowScene, ADentStaysWhereAnElasticBodySpringsBack) {
  // A ball is pressed into a cube and taken away again.
  const auto height = [](const std::string& plastic) {
    const std::string text = fmt::format(R"(fps = 60
gravity = [0, 0, 0]
[[body]]
name = "cube"
box = {{ extent = [0.2, 0.2, 0.2], cells = [5, 5, 5] }}
material = {{ model = "neo-hookean", young = 1e5, poisson = 0.3 }}
{}
[[body.handles]]
name = "base"
select = {{ box = [[0, 0, 0], [1, 0, 1]] }}
[[collider]]
name = "ball"
shape = {{ sphere = {{ radius = 0.08 }} }}
position = [0, 0.29, 0]
keys = [{{ t = 0 }}, {{ t = 0.4, move = [0, -0.07, 0] }}, {{ t = 0.8 }}]
)",
                                         plastic);
    World world(test::scene_of(text), assemble(test::scene_of(text)));
    world.start({make_rule, settings_of}, nullptr);
    for (int frame = 0; frame < 90; ++frame) EXPECT_TRUE(world.play(frame));
    const Model& model = world.body(0).model();
    double lowest = 1;
    for (int v = 0; v < model.vertices; ++v)
      if (model.rest(v, 1) > 0.2 - 1e-9) lowest = std::min(lowest, world.body(0).state().x(v, 1));
    EXPECT_FALSE(is_tangled(model, world.body(0).state().x));
    return lowest;
  };
  EXPECT_NEAR(height(""), 0.2, 0.001);
  const double dented = height("plastic = { yield = 5e3, hardening = 1e4 }");
  EXPECT_LT(dented, 0.175);
  EXPECT_GT(dented, 0.145) << "it goes no deeper than it was pushed, but for what swings";
}

TEST_F(FlowScene, OneMessageSaysWhatCannotFlow) {
  const auto problem = [](const std::string& body) {
    const std::vector<std::string> found = test::problems_of("[[body]]\n" + body);
    return found.size() == 1 ? found.front() : fmt::format("{} problems", found.size());
  };
  const std::string box = "box = { extent = [0.1, 0.1, 0.1], cells = [2, 2, 2] }\n";
  const std::string rubber = box + "material = { model = \"neo-hookean\", mu = 1e4, lambda = 1e4 }\n";
  EXPECT_NE(problem("cloth = { extent = [1, 1], cells = [4, 4], stretch = 100 }\nplastic = { yield = 1 }\n")
                .find("plastic: of solids"),
            std::string::npos);
  EXPECT_NE(problem(rubber + "fibre = { kappa = 1e4 }\ncreep = { time = 1 }\n").find("alike in all directions"),
            std::string::npos);
  EXPECT_NE(problem(rubber + "creep = { time = 1 }\nsolver = { matrix = \"turned-hessian\" }\n").find("rest shape"),
            std::string::npos);
  EXPECT_NE(problem(rubber + "creep = { time = 1 }\nsolver = { method = \"admm\" }\n").find("rest shape"),
            std::string::npos);
  EXPECT_NE(problem(rubber + "plastic = { hardening = 1 }\n").find("yield"), std::string::npos);
  EXPECT_NE(problem(rubber + "plastic = { yield = -1 }\n").find("yield"), std::string::npos);
  EXPECT_NE(problem(rubber + "creep = { time = 1, share = 1 }\n").find("share"), std::string::npos);
  const SceneDef scene = test::scene_of("[[body]]\n" + rubber +
                                        "plastic = { yield = 1e3, limit = 2 }\ncreep = { time = 1 }\n"
                                        "solver = { method = \"newton\" }\n");
  EXPECT_EQ(scene.bodies.front().plastic->limit, 2);
  EXPECT_EQ(scene.bodies.front().creep->share, 0.5);
  Body body = assemble(scene).front();
  BodyDef without = body.def;
  without.plastic.reset();
  EXPECT_THROW(update_body(body, scene, without), InputError);
}

}  // namespace flow_world_test
}  // namespace supple
