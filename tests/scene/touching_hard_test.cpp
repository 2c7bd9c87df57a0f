// Tests worlds whose bodies touch each other where that is hard: bodies that start in each other, and bodies of very
// unlike stiffness or density. `supple bench stability` has more of these (app/bench/meeting_cases.h).
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <memory>

#include "baselines/make_rule.h"
#include "film/record/pair_recorder.h"
#include "output/run/row_tally.h"
#include "scene/building/body_depths.h"
#include "sim/measures/energies.h"
#include "sim/measures/measures.h"
#include "sim/solver/open_workspace.h"
#include "support/scene_text.h"
#include "world/world.h"

namespace supple {
namespace touching_hard_test {

struct Played {
  explicit Played(const std::string& text)
      : threads(1), world(test::scene_of(text), assemble(test::scene_of(text))), pairs(world, FrameRows()) {
    world.start({make_rule, settings_of}, &threads);
    for (std::size_t b = 0; b < world.size(); ++b) workspaces.push_back(std::make_unique<OpenWorkspace>());
  }
  // Plays a frame. Returns whether every number is finite.
  bool play(int frame) {
    if (!world.play(frame)) return false;
    FrameRow row;
    row.frame = frame;
    pairs.record(row);
    tally.add(row);
    bool finite = true;
    for (std::size_t b = 0; b < world.size(); ++b)
      finite = finite && world.body(b).state().x.allFinite() && world.body(b).state().v.allFinite();
    return finite;
  }
  Positions places(std::size_t body) const {
    return in_input_order(world.body(body).model(), world.body(body).state().x);
  }
  // Returns the overlaps of bodies that are there now.
  std::vector<BodyDepth> overlaps() const {
    std::vector<Positions> points;
    for (std::size_t b = 0; b < world.size(); ++b) points.push_back(places(b));
    return overlaps_of_bodies(world.bodies(), points);
  }
  // Returns how deep bodies are in each other now, over the smaller one's size.
  double depth() const {
    double deepest = 0;
    for (const BodyDepth& pair : overlaps()) deepest = std::max(deepest, pair.share);
    return deepest;
  }
  // Returns the kinetic, elastic and gravitational energy of all bodies [J].
  double energy() {
    double sum = 0;
    for (std::size_t b = 0; b < world.size(); ++b) {
      const MovingBody& body = world.body(b);
      workspaces[b]->prepare(body.model(), body.inputs().solver);
      sum += energies(body.model(), body.state(), world.scene().gravity, *workspaces[b]).total();
    }
    return sum;
  }

  Threads threads;
  World world;
  PairRecorder pairs;
  RowTally tally;
  std::vector<std::unique_ptr<OpenWorkspace>> workspaces;  // for energies alone
};

std::string cube(const std::string& name, int cells, double young, const std::string& keys) {
  return fmt::format(
      "[[body]]\nname = \"{}\"\nbox = {{ extent = [0.2, 0.2, 0.2], cells = [{}, {}, {}] }}\n"
      "material = {{ model = \"stable-neo-hookean\", young = {}, poisson = 0.35 }}\n{}\n",
      name, cells, cells, cells, young, keys);
}

// Returns a cube that falls 0.03 m onto another one, which stands on the ground.
std::string fallen(double lower_young, const std::string& lower, double upper_young, const std::string& upper) {
  return cube("lower", 4, lower_young, lower + "position = [0, 0.001, 0]") +
         cube("upper", 3, upper_young, upper + "position = [0.03, 0.23, 0.02]") +
         "[[collider]]\nname = \"ground\"\nshape = { half_space = { normal = [0, 1, 0] } }\nfriction = 0.5\n";
}

// Each vertex is pushed out no faster than push_out sizes a second, which gives the energy of all mass at this speed.
// Before the cubes come apart, planes that move out also press them, and as much again may stay with them: of twelve
// random starts, half end above the first of these.
TEST(TouchingHard, CubesThatStartPartlyInEachOtherComeApart) {
  Played played("gravity = [0, 0, 0]\n" + cube("first", 4, 3e4, "") +
                cube("second", 3, 3e4, "position = [0.13, 0.04, 0.03]\nstart = { turn_deg = [20, 30, 10] }"));
  ASSERT_GT(played.depth(), 0.01);
  const double size = std::max(played.world.body(0).model().size, played.world.body(1).model().size);
  const double mass = played.world.body(0).model().total_mass + played.world.body(1).model().total_mass;
  const double speed = played.world.scene().bodies.front().solver.settings.contact.push_out * size;
  const double given = 0.5 * mass * speed * speed;
  const double start = played.energy();
  double lowest = std::numeric_limits<double>::infinity();  // since the cubes first came apart
  for (int frame = 0; frame < 60; ++frame) {
    ASSERT_TRUE(played.play(frame)) << frame;
    const double now = played.energy();
    EXPECT_LT(now - start, 6 * given) << frame;
    if (played.world.touches().empty() && played.overlaps().empty()) lowest = std::min(lowest, now);
    EXPECT_LT(now - lowest, 0.01 * given) << frame;
  }
  EXPECT_TRUE(played.overlaps().empty()) << played.depth();
  EXPECT_LT(lowest - start, 2 * given);
}

// Small steps damp nothing: if each point left by what is closest to it, or if the way changed from step to step, the
// cubes would be torn and thrown apart with hundreds of joules, or hang in each other.
TEST(TouchingHard, CubesThatStartDeepInEachOtherComeApartWholeInSmallStepsToo) {
  for (const int substeps : {1, 12}) {
    Played played(fmt::format("substeps = {}\ngravity = [0, 0, 0]\n", substeps) + cube("first", 4, 3e4, "") +
                  cube("second", 3, 3e4, "position = [0.06, -0.02, 0.01]\nstart = { turn_deg = [20, 30, 10] }"));
    ASSERT_GT(played.depth(), 0.1);
    const double size = played.world.body(0).model().size;
    const double mass = played.world.body(0).model().total_mass + played.world.body(1).model().total_mass;
    const double start = played.energy();
    double stretch = 1, most = 0;
    for (int frame = 0; frame < 60; ++frame) {
      ASSERT_TRUE(played.play(frame)) << frame;
      most = std::max(most, played.energy() - start);
      for (std::size_t b = 0; b < 2; ++b) {
        const MovingBody& body = played.world.body(b);
        stretch = std::max(stretch, deformation(body.model(), body.state().x).stretch);
      }
    }
    EXPECT_TRUE(played.overlaps().empty()) << substeps << " " << played.depth();
    EXPECT_LT(stretch, 1.5) << substeps;
    EXPECT_LT(most, 6 * 0.5 * mass * size * size) << substeps;  // of all mass at one size a second
  }
}

// The small cube leaves by one side: if each of its points left by the side that is closest to it, it would stay, torn.
TEST(TouchingHard, ASmallCubeThatStartsWhollyInsideAnotherLeavesItWhole) {
  for (const char* turn : {"[0, 0, 0]", "[10, 20, 30]", "[60, 5, 45]"}) {
    Played played("gravity = [0, 0, 0]\n" + cube("outer", 4, 3e4, "") +
                  "[[body]]\nname = \"inner\"\nbox = { extent = [0.08, 0.08, 0.08], cells = [3, 3, 3] }\n"
                  "material = { model = \"stable-neo-hookean\", young = 3e4, poisson = 0.35 }\n"
                  "position = [0.02, 0.065, 0.01]\nturn_deg = " +
                  turn + "\n");
    EXPECT_GT(played.depth(), 0.3) << turn;
    double longest = 0;
    const double size = played.world.body(1).model().size;
    for (int frame = 0; frame < 45; ++frame) {
      ASSERT_TRUE(played.play(frame)) << frame;
      longest = std::max(longest, bounds_of(played.places(1)).diagonal());
    }
    EXPECT_TRUE(played.overlaps().empty()) << turn << " " << played.depth();
    EXPECT_LT(longest, 1.5 * size) << turn;
  }
}

TEST(TouchingHard, ASoftCubeThatFallsOnOneTenThousandTimesAsStiffStaysOutside) {
  Played played(fallen(3e8, "", 3e4, ""));
  bool touched = false;
  for (int frame = 0; frame < 45; ++frame) {
    ASSERT_TRUE(played.play(frame)) << frame;
    EXPECT_LT(played.depth(), 0.02) << frame;
    for (const BodyTouch& touch : played.world.touches()) {
      touched = true;
      EXPECT_LT(touch.depth, 0.02 * played.world.body(1).model().size) << frame;
    }
  }
  EXPECT_TRUE(touched);
  EXPECT_GT(played.places(1).col(1).mean(), played.places(0).col(1).mean() + 0.1);
}

// The upper cube weighs as much as compresses the lower one by a fifteenth.
TEST(TouchingHard, ACubeOnOneAThousandTimesAsLightStaysAboveItOrIsSaidToBeDeepInIt) {
  Played played(fallen(3e4, "density = 1\n", 3e4, "density = 1000\n"));
  ASSERT_NEAR(played.world.body(1).model().total_mass / played.world.body(0).model().total_mass, 1000, 1e-6);
  double deepest = 0;
  bool is_through = false;
  for (int frame = 0; frame < 45; ++frame) {
    ASSERT_TRUE(played.play(frame)) << frame;
    deepest = std::max(deepest, played.depth());
    is_through |= played.places(1).col(1).mean() < played.places(0).col(1).mean();
  }
  const std::vector<std::string> said = played.tally.warnings();
  const bool tells = std::ranges::any_of(
      said, [](const std::string& warning) { return warning.find("deep in each other") != std::string::npos; });
  EXPECT_TRUE((deepest <= DeepBodies::deep && !is_through) || tells) << deepest;
}

}  // namespace touching_hard_test
}  // namespace supple
