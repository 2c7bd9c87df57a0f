// Tests seams of cloth in scenes: that panels close, what that does to the balance of energy, the same bits on any
// number of threads and after a restart, and what is said of seams or refused.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <vector>

#include "base/error.h"
#include "geometry/triangles/triangle_edges.h"
#include "scene/building/assemble.h"
#include "scene/building/seam_pairs.h"
#include "scene/building/warnings.h"
#include "support/bodies.h"
#include "support/energy_watch.h"
#include "support/panels.h"
#include "support/played_world.h"

namespace supple {
namespace seam_scene_test {

class SewnPanels : public testing::Test {
 protected:
  void SetUp() override {
    test::write_panels(folder_.path / "panels.obj");
    write(test::sewn_panels());
  }
  void write(const std::string& text) { std::ofstream(folder_.path / "scene.toml") << text; }
  World world(const std::vector<std::string>& settings = {}) const {
    return test::world_of(folder_.path / "scene.toml", settings);
  }
  // Returns how far the seams of a body are open, over the mean edge.
  static double open(const World& world) {
    const Model& model = world.body(0).model();
    const Positions closed = Positions::Zero(std::ssize(model.seams.pairs), 3);
    return widest_seam(model, closed, world.body(0).state().x) / mean_edge(model.surface, model.rest);
  }
  // Returns the messages about the scene with other seams.
  std::vector<std::string> problems(const std::string& seams) {
    write(
        fmt::format("[[body]]\nname = \"bag\"\ncloth = {{ surface = \"panels.obj\", seams = [\n  {}\n] }}\n"
                    "material = \"cotton\"\n",
                    seams));
    std::vector<std::string> found;
    try {
      (void)world();
    } catch (const InputError& error) {
      for (const Problem& problem : error.problems()) found.push_back(problem.text());
    }
    return found;
  }
  test::TemporaryFolder folder_;
};

TEST_F(SewnPanels, OfDifferentNumbersOfVerticesCloseInTheirTime) {
  World sewn = world();
  const std::vector<SeamPair>& pairs = sewn.body(0).model().seams.pairs;
  EXPECT_EQ(pairs.size(), 18u);  // the front has nine vertices along each side, the back has seven
  for (const SeamPair& pair : pairs) {
    EXPECT_NEAR(pair.gap.norm(), 0.2, 1e-7);
    EXPECT_NEAR(pair.factor[0] + pair.factor[1] + pair.factor[2], 0, 1e-12);
  }
  EXPECT_GT(open(sewn), 4);
  for (int frame = 0; frame < 7; ++frame) ASSERT_TRUE(sewn.play(frame));
  EXPECT_GT(open(sewn), 2) << "half of the time is not all of it";
  for (int frame = 7; frame < 24; ++frame) ASSERT_TRUE(sewn.play(frame));
  EXPECT_LT(open(sewn), 0.01);
}

// Implicit midpoint damps nothing, so that what is left swings to and fro, as chance will have it: round-off alone
// takes it from 0.03 to 0.3.
TEST_F(SewnPanels, CloseByImplicitMidpointToo) {
  std::vector<double> left;
  for (const double gravity : {-9.81, -9.81 - 1e-9, -9.81 - 2e-9, -9.81 - 3e-9, -9.81 - 4e-9}) {
    World sewn = world({"solver.integrator=implicit-midpoint", fmt::format("gravity=[0, {}, 0]", gravity)});
    EXPECT_GT(open(sewn), 4);
    for (int frame = 0; frame < 7; ++frame) ASSERT_TRUE(sewn.play(frame));
    EXPECT_GT(open(sewn), 2);
    for (int frame = 7; frame < 24; ++frame) ASSERT_TRUE(sewn.play(frame));
    left.push_back(open(sewn));
  }
  std::sort(left.begin(), left.end());
  EXPECT_LT(left[left.size() / 2], 0.1);
  EXPECT_LT(left.back(), 1);
}

TEST_F(SewnPanels, TheWorkOfClosingIsInTheBalanceOfEnergy) {
  double put_in = 0;
  World hanging = world();
  EXPECT_LT(test::share_from_nothing(hanging, 20, put_in), 0.01);
  EXPECT_GT(put_in, 1e-3);
  for (const int iterations : {10, 100}) {  // nothing but the seams moves the panels here
    World floating = world({"gravity=[0, 0, 0]", fmt::format("solver.iterations={}", iterations)});
    EXPECT_LT(test::share_from_nothing(floating, 20, put_in), 0.01) << iterations;
    EXPECT_GT(put_in, 1e-4) << iterations;
    EXPECT_LT(put_in, 0.01) << iterations;
  }
}

TEST_F(SewnPanels, HaveTheSameBitsOnAnyNumberOfThreadsAndAfterARestart) {
  const auto play = [](World& world, int end) {
    while (world.frames() < end) EXPECT_TRUE(world.play(world.frames()));
    return world.hash();
  };
  World one = world();
  const std::uint64_t early = play(one, 6);
  const WorldState middle = one.state();
  const std::uint64_t hash = play(one, 16);
  World again = world();
  again.restore(middle);
  EXPECT_EQ(again.hash(), early);
  EXPECT_EQ(play(again, 16), hash);
  Threads threads(2);
  Script script = Script::load(folder_.path / "scene.toml", test::assets, {});
  std::vector<Body> bodies = assemble(script.scene());
  World other(std::move(script), std::move(bodies));
  other.start({make_rule, settings_of}, &threads);
  EXPECT_EQ(play(other, 16), hash);
}

TEST_F(SewnPanels, CloseAlsoWhereTheyMeetAnotherBody) {
  write(
      test::sewn_panels("[[body]]\nname = \"ball\"\nbox = { extent = [0.1, 0.1, 0.1], cells = [2, 2, 2] }\n"
                        "material = \"rubber\"\nposition = [0, 0.6, 0]\ndensity = 100\n"
                        "[[body.handles]]\nname = \"all\"\nselect = { box = [[0, 0, 0], [1, 0.4, 1]] }\n"));
  World sewn = world();
  bool met = false;
  for (int frame = 0; frame < 24; ++frame) {
    ASSERT_TRUE(sewn.play(frame));
    met |= sewn.body(0).is_in_island();
  }
  EXPECT_TRUE(met);
  EXPECT_LT(open(sewn), 0.05);
}

TEST_F(SewnPanels, AreSaidInANoteAndUnevenOnesInAWarning) {
  const SceneDef scene = Script::load(folder_.path / "scene.toml", test::assets, {}).scene();
  const Body body = assemble(scene).front();
  EXPECT_NE(
      fmt::format("{}", fmt::join(body.notes, "\n"))
          .find("2 seams join 18 pairs of places on its border, which are up to 0.2 m apart at the start and meet "
                "after 0.25 s"),
      std::string::npos)
      << fmt::format("{}", fmt::join(body.notes, "\n"));
  EXPECT_EQ(uneven_seam_text(body, 0), "");
  EXPECT_EQ(problems("{ side = [[0, 0, 1], [0, 1, 1]], onto = [[0, 0, 0], [0, 0.66, 0]] }").size(), 0u);
  const SceneDef uneven = Script::load(folder_.path / "scene.toml", test::assets, {}).scene();
  std::string said;
  for (const Warning& warning : warnings(uneven, assemble(uneven))) said += warning.problem.text() + "\n";
  EXPECT_NE(said.find("a seam of body 'bag' joins 0.3 m of border with 0.2 m: the longer side gathers"),
            std::string::npos)
      << said;
}

TEST_F(SewnPanels, MistakesAreNamedWithTheirPlace) {
  const std::pair<std::string, std::string> texts[] = {
      {"{ side = [[0, 0, 1], [0, 1, 1]] }", "'onto' is missing"},
      {"{ side = [[0, 0, 1]], onto = [[0, 0, 0], [0, 1, 0]] }", "side: two points at least"},
      {"{ side = [[0, 0, 1], [0, 1, 1]], onto = [[0, 0, 0], [0, 1, 0]], edge = 1 }", "edge"},
      {"{ side = [[0, 0, 3], [0, 1, 1]], onto = [[0, 0, 0], [0, 1, 0]] }",
       "side of a seam of body 'bag': the point [0, 0, 3] is 0.4 m from the border of the cloth; a tenth of its size, "
       "0.054 m, is allowed"},
      {"{ side = [[0, 0, 1], [0, 1, 0]], onto = [[0, 0, 0], [0, 1, 0]] }",
       "are on two borders, and no border leads from one to the other"},
      {"{ side = [[0, 0, 1], [0, 0.01, 1]], onto = [[0, 0, 0], [0, 1, 0]] }",
       "the points [0, 0, 1] and [0, 0.01, 1] are nearest to the same vertex of the border"},
      {"{ side = [[0, 0, 1], [0, 1, 1], [0, 0.5, 1]], onto = [[0, 0, 0], [0, 1, 0]] }",
       "it goes along the same border twice"},
      {"{ side = [[0, 0, 1], [0, 1, 1]], onto = [[0, 0.5, 1], [1, 1, 1]] }",
       "onto of a seam of body 'bag': it goes along the same border as the other side"},
      {"{ side = [[0, 0, 1], [0, 1, 1]], onto = [[0, 0, 1], [0, 1, 1]] }", "it is the same stretch of border"},
  };
  for (const auto& [seams, message] : texts) {
    const std::vector<std::string> found = problems(seams);
    ASSERT_EQ(found.size(), 1u) << seams << "\n" << fmt::format("{}", fmt::join(found, "\n"));
    EXPECT_NE(found.front().find("scene.toml:4:"), std::string::npos) << found.front();
    EXPECT_NE(found.front().find(message), std::string::npos) << found.front();
  }
  const std::vector<std::string> idle = test::problems_of(
      "[[body]]\ncloth = { extent = [1, 1], cells = [4, 4], seam_time = 2 }\nmaterial = \"cotton\"\n");
  ASSERT_EQ(idle.size(), 1u);
  EXPECT_NE(idle.front().find("seam_time: of seams; there are none here"), std::string::npos) << idle.front();
}

// A dart takes a wedge out of a grid: its sides meet at their tip. A ring sews a whole border to another one.
TEST_F(SewnPanels, SidesMayShareTheirEndsAndGoAroundAWholeBorder) {
  EXPECT_EQ(problems("{ side = [[0, 1, 1], [0, 0, 1]], onto = [[0, 1, 1], [1, 1, 1]] }").size(), 0u);
  World dart = world();
  for (const SeamPair& pair : dart.body(0).model().seams.pairs) EXPECT_GT(pair.gap.norm(), 1e-3);
  EXPECT_EQ(problems("{ side = [[0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1], [0, 0, 1]], "
                     "onto = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 0]] }")
                .size(),
            0u);
  World ring = world();
  EXPECT_EQ(ring.body(0).model().seams.pairs.size(), 41u);  // the first of 40 vertices is there twice
}

}  // namespace seam_scene_test
}  // namespace supple
