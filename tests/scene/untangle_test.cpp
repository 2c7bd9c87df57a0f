// Bodies that start inside out, folded or collapsed come apart with solver.untangle, and nothing else changes by it.
#include <gtest/gtest.h>

#include "base/hash.h"
#include "baselines/make_rule.h"
#include "sim/measures/measures.h"
#include "support/scene_text.h"
#include "world/world.h"

namespace supple {
namespace untangle_test {

std::string cube(const std::string& model, const std::string& keys, const std::string& untangle = "true") {
  return "gravity = [0, 0, 0]\n[solver]\nuntangle = " + untangle +
         "\n[[body]]\nbox = { extent = [0.2, 0.2, 0.2], cells = [3, 3, 3] }\nmaterial = { model = \"" + model +
         "\", young = 3e4, poisson = 0.35 }\n" + keys;
}

// A scene of one body, with a step a frame.
struct Played {
  explicit Played(const std::string& text, int count = 1)
      : threads(count), world(test::scene_of(text), assemble(test::scene_of(text))) {
    world.start({make_rule, settings_of}, &threads);
  }

  // Makes frames from `first` on; returns how many of them were untangled.
  int play(int first, int end) {
    int untangled = 0;
    for (int frame = first; frame < end; ++frame) {
      EXPECT_TRUE(world.play(frame));
      untangled += body().untangled() ? 1 : 0;
    }
    return untangled;
  }
  MovingBody& body() { return world.body(0); }
  const State& state() const { return world.body(0).state(); }
  const Model& model() const { return world.body(0).model(); }
  std::uint64_t hash() const { return world.hash(); }
  Deformation shape() const { return deformation(model(), state().x); }

  Threads threads;
  World world;
};

TEST(Untangle, BodiesComeToRestThatWouldStayFolded) {
  for (const char* model : {"neo-hookean", "st-venant-kirchhoff", "stable-neo-hookean"}) {
    for (const char* start : {"start = { random = [0.2, 0.2, 0.2] }", "start = { stretch = [-1, 1, 1] }",
                              "start = { flatten = \"point\" }"}) {
      Played played(cube(model, start));
      const int untangled = played.play(0, 90);
      EXPECT_GE(untangled, 1) << model << start;
      EXPECT_LE(untangled, 15) << model << start;
      EXPECT_FALSE(is_tangled(played.model(), played.state().x)) << model << start;
      EXPECT_LT(played.shape().stretch, 1.06) << model << start;
    }
  }
  Played folded(cube("neo-hookean", "start = { random = [0.2, 0.2, 0.2] }", "false"));
  EXPECT_EQ(folded.play(0, 90), 0);
  EXPECT_GT(folded.shape().stretch, 1.06);
}

TEST(Untangle, ABodyThatIsNotTangledKeepsItsBits) {
  const std::string start = "start = { stretch = [2, 1, 1] }";
  Played with(cube("neo-hookean", start)), without(cube("neo-hookean", start, "false"));
  EXPECT_EQ(with.play(0, 20), 0);
  without.play(0, 20);
  EXPECT_EQ(with.hash(), without.hash());
}

TEST(Untangle, BitsDependNeitherOnThreadsNorOnWhereARunWasResumed) {
  const std::string scene = cube("st-venant-kirchhoff", "start = { stretch = [10, 10, 10] }");
  Played one(scene), two(scene, 2), resumed(scene);
  one.play(0, 1);
  const State middle = one.state();
  EXPECT_GE(one.play(1, 30), 1) << "the state in the middle is tangled";
  two.play(0, 30);
  EXPECT_EQ(one.hash(), two.hash());
  resumed.body().restore(middle);
  resumed.play(1, 30);
  EXPECT_EQ(one.hash(), resumed.hash());
}

TEST(Untangle, HeldVerticesStayHeld) {
  const std::string handle =
      "start = { random = [0.2, 0.2, 0.2] }\n[[body.handles]]\nname = \"end\"\nselect = { box = [[0, 0, 0], [0.01, 1, "
      "1]] }\n";
  Played played(cube("neo-hookean", handle));
  EXPECT_GE(played.play(0, 90), 1);
  for (int v = played.model().free; v < played.model().vertices; ++v)
    EXPECT_EQ(played.state().x.row(v), played.model().rest.row(v));
  EXPECT_LT(played.shape().stretch, 1.06);
}

}  // namespace untangle_test
}  // namespace supple
