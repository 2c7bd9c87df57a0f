// Tests worlds whose bodies touch each other or themselves: against a wall in their middle, against what must be kept,
// and for the same bits however the film is made.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "app/bench/linked_rings.h"
#include "baselines/make_rule.h"
#include "scene/building/body_depths.h"
#include "sim/contact/own_sheet.h"
#include "sim/contact/own_surface.h"
#include "sim/model/element_view.h"
#include "support/played_world.h"
#include "world/world.h"

namespace supple {
namespace touching_worlds_test {

struct Played : test::PlayedWorld {
  using PlayedWorld::PlayedWorld;
  // Returns the sums of m v and of m |v|^2 / 2 over all bodies.
  Vec3 momentum() const {
    Vec3 sum = Vec3::Zero();
    for (std::size_t b = 0; b < world.size(); ++b) sum += momentum(b);
    return sum;
  }
  Vec3 momentum(std::size_t body) const {
    const Model& model = world.body(body).model();
    Vec3 sum = Vec3::Zero();
    for (int v = 0; v < model.free; ++v) sum += model.mass[v] * world.body(body).state().v.row(v).transpose();
    return sum;
  }
};

std::string cube(const std::string& name, double x, double speed, const std::string& keys = "") {
  return fmt::format(
      "[[body]]\nname = \"{}\"\nbox = {{ extent = [0.2, 0.2, 0.2], cells = [4, 4, 4] }}\nposition = [{}, 0.5, 0]\n"
      "velocity = [{}, 0, 0]\nmaterial = {{ model = \"stable-neo-hookean\", young = 1e5, poisson = 0.4 }}\n{}\n",
      name, x, speed, keys);
}
const std::string no_gravity = "gravity = [0, 0, 0]\n";
const std::string smooth = "contact = { friction = 0 }";
const std::string wall = "[[collider]]\nname = \"wall\"\nshape = { half_space = { normal = [-1, 0, 0] } }\n";
constexpr double diagonal = 0.2 * 1.7320508;  // of the cube [m]

// Plays two cubes that meet head-on beside one that meets a wall in their middle. Returns the most that the left ones
// are apart, over their diagonal. With four steps a frame, a step begins with the faces in one place, as far as
// round-off lets it. At 8 m/s a step leads the cubes through each other.
double most_apart(double speed, int substeps, int frames) {
  const std::string head = no_gravity + fmt::format("substeps = {}\n", substeps);
  Played two(head + cube("left", -0.25, speed, smooth) + cube("right", 0.25, -speed, smooth));
  Played one(head + cube("left", -0.25, speed) + wall);
  double most = 0;
  for (int frame = 0; frame < frames; ++frame) {
    two.play(frame, frame + 1);
    one.play(frame, frame + 1);
    most = std::max(most, (two.places(0) - one.places(0)).rowwise().norm().maxCoeff() / diagonal);
  }
  return most;
}

TEST(TouchingWorlds, TwoCubesThatMeetHeadOnAreEachOthersWall) {
  for (const int substeps : {1, 2, 4}) EXPECT_LT(most_apart(2, substeps, 60), 0.01) << substeps;
  for (const int substeps : {2, 4}) EXPECT_LT(most_apart(8, substeps, 3), 0.05) << substeps;
}

// The left cube turns over while it pushes the right one, whose way is straight.
TEST(TouchingWorlds, EachBodySaysHowFarItIsFromItsOwnSolution) {
  Played played(no_gravity + cube("left", -0.25, 3, "spin_deg = [0, 400, 900]") + cube("right", 0.05, 0));
  bool differ = false;
  for (int frame = 0; frame < 6; ++frame) {
    played.play(frame, frame + 1);
    const StepReport &left = played.world.body(0).report(), &right = played.world.body(1).report();
    if (left.error_estimate == 0 || left.error_estimate != right.error_estimate) continue;  // two steps
    EXPECT_EQ(std::max(left.motion_estimate, right.motion_estimate), *std::ranges::max_element(left.motion_estimates));
    differ = differ || left.motion_estimate != right.motion_estimate;
  }
  EXPECT_TRUE(differ);
}

TEST(TouchingWorlds, MomentumIsKept) {
  Played played(no_gravity + cube("left", -0.25, 3) + cube("right", 0.25, -1, "turn_deg = [10, 20, 30]"));
  const Vec3 before = played.momentum();
  const double one = played.momentum(0).norm();
  double exchanged = 0;
  for (int frame = 0; frame < 20; ++frame) {
    const Vec3 left = played.momentum(0);
    played.play(frame, frame + 1);
    exchanged += (played.momentum(0) - left).norm();
    EXPECT_LT((played.momentum() - before).norm(), 1e-12 * exchanged + 1e-14 * one) << frame;
  }
  EXPECT_GT(exchanged, 0.5 * one);
}

TEST(TouchingWorlds, ABodyThatNothingTouchesMakesItsOwnStep) {
  Played together(no_gravity + cube("left", -0.25, 2) + cube("right", 2, 1) + wall);
  Played alone(no_gravity + cube("left", -0.25, 2) + wall);
  together.play(0, 10);
  alone.play(0, 10);
  EXPECT_EQ(together.places(0), alone.places(0));
}

TEST(TouchingWorlds, BodiesThatDoNotMeetPassThroughEachOther) {
  Played played(no_gravity + cube("left", -0.25, 2, "contact = { meets = false }") + cube("right", 0.25, -2));
  played.play(0, 10);
  const double way = 2 * 10.0 / 30;
  EXPECT_NEAR(played.places(0).col(0).mean(), -0.25 + way, 1e-3 * way);
}

TEST(TouchingWorlds, ABodyRestsOnAnother) {
  const std::string ground =
      "[[collider]]\nname = \"ground\"\nshape = { half_space = { normal = [0, 1, 0] } }\n"
      "friction = 0.5\n";
  std::string low = cube("low", 0, 0), high = cube("high", 0.03, 0);
  low.replace(low.find("0.5, 0]"), 7, "0.101, 0]");
  high.replace(high.find("0.5, 0]"), 7, "0.31, 0.02]");
  Played played(low + high + ground);
  played.play(0, 60);
  const Positions before = played.places(1);
  played.play(60, 90);
  EXPECT_LT((played.places(1) - before).rowwise().norm().maxCoeff(), 1e-3 * diagonal) << "in a second";
  ASSERT_EQ(played.world.touches().size(), 1u);
  const BodyTouch& touch = played.world.touches().front();
  const double weight = played.world.body(1).model().total_mass * 9.81;
  EXPECT_NEAR(touch.force.y(), weight, 0.01 * weight);
  EXPECT_LT(touch.depth, 0.005 * diagonal);
  EXPECT_NEAR(played.world.body(1).report().contact_force.y(), weight, 0.01 * weight);
}

TEST(TouchingWorlds, LinkedRingsStayLinked) {
  struct Throw {
    double speed, young;
    int substeps;
  };
  for (const auto& [speed, young, substeps] : {Throw{1, 2e5, 1}, {12, 2e5, 1}, {20, 2e6, 1}, {20, 2e6, 4}}) {
    const auto ring = [&](const char* name, double y, double turn, double v, const char* keys) {
      return fmt::format(
          "[[body]]\nname = \"{}\"\nshape = \"shapes/ring.toml\"\nscale = 0.25\nvertices = 400\n"
          "position = [0, {}, 0]\nturn_deg = [0, {}, 0]\nvelocity = [0, {}, 0]\n"
          "material = {{ model = \"stable-neo-hookean\", young = {}, poisson = 0.4 }}\n{}\n",
          name, y, turn, v, young, keys);
    };
    Played played(
        fmt::format("substeps = {}\n", substeps) + no_gravity +
        ring("held", 1, 0, 0, "[[body.handles]]\nname = \"hook\"\nselect = { box = [[0, 0.85, 0], [1, 1, 1]] }") +
        ring("thrown", 0.71, 90, -speed, ""));
    const auto linked = [&] {
      const auto line = [&](std::size_t b) {
        return middle_line_of_ring(played.world.bodies()[b].description.mesh.rest, played.places(b));
      };
      return std::abs(linking_number(line(0), line(1)));
    };
    EXPECT_NEAR(linked(), 1, 1e-6) << speed;
    for (int frame = 0; frame < 30; ++frame) {
      played.play(frame, frame + 1);
      EXPECT_NEAR(linked(), 1, 1e-6) << speed << " x " << young << " x " << substeps << ", frame " << frame;
    }
  }
}

const std::string pile = [] {
  std::string text =
      "[[collider]]\nname = \"ground\"\nshape = { half_space = { normal = [0, 1, 0] } }\nfriction = 0.5\n";
  for (int i = 0; i < 3; ++i) {
    std::string one = cube(fmt::format("c{}", i), 0.04 * i, 0);
    one.replace(one.find("0.5, 0]"), 7, fmt::format("{}, 0]", 0.12 + 0.22 * i));
    text += one;
  }
  return text;
}();

TEST(TouchingWorlds, HaveTheSameBitsForAllThreads) {
  Played one(pile, 1), two(pile, 2);
  one.play(0, 20);
  two.play(0, 20);
  EXPECT_EQ(one.world.hash(), two.world.hash());
}

TEST(TouchingWorlds, GoOnFromAnyState) {
  Played whole(pile), parts(pile);
  std::vector<WorldState> states;
  for (int frame = 0; frame < 20; ++frame) {
    whole.play(frame, frame + 1);
    states.push_back(whole.world.state());
  }
  for (const int from : {3, 11, 7}) {
    parts.world.restore(states[from]);
    parts.play(from + 1, 20);
    EXPECT_EQ(parts.world.hash(), whole.world.hash()) << from;
  }
}

// A cloth of one metre that is held along its border.
std::string held_cloth(int cells) {
  return fmt::format(
      "[[body]]\nname = \"held\"\ncloth = {{ extent = [1, 1], cells = [{0}, {0}], stretch = 2000, bend = 2 }}\n"
      "turn_deg = [-90, 0, 0]\nposition = [0, 1, 0]\ntotal_mass = 0.3\n"
      "[[body.handles]]\nname = \"a\"\nselect = {{ box = [[0, 0, 0], [0.01, 1, 1]] }}\n"
      "[[body.handles]]\nname = \"b\"\nselect = {{ box = [[0.99, 0, 0], [1, 1, 1]] }}\n",
      cells);
}

TEST(TouchingWorlds, AClothCatchesABallThatIsThrownAtIt) {
  for (const double speed : {1.0, 3.0, 6.0}) {  // [m/s]; the fastest one goes its own size in a step
    for (const int cells : {8, 24}) {           // edges above and below the ball's
      Played played(held_cloth(cells) +
                    fmt::format("[[body]]\nname = \"ball\"\nshape = \"shapes/sphere.toml\"\nsize = 0.2\n"
                                "vertices = 300\nposition = [0.03, 1.05, 0.02]\nvelocity = [0, -{}, 0]\ndensity = 100\n"
                                "material = {{ model = \"stable-neo-hookean\", young = 5e4, poisson = 0.4 }}\n",
                                speed));
      double lowest = infinity;
      for (int frame = 0; frame < 30; ++frame) {
        played.play(frame, frame + 1);
        const Positions ball = played.places(1), cloth = played.places(0);
        const Eigen::RowVector3d middle = ball.colwise().mean();
        double below = infinity;  // the cloth's lowest vertex within the ball's width
        for (Eigen::Index v = 0; v < cloth.rows(); ++v) {
          if (std::hypot(cloth(v, 0) - middle[0], cloth(v, 2) - middle[2]) < 0.1) below = std::min(below, cloth(v, 1));
        }
        EXPECT_GT(middle[1], below) << speed << " m/s, " << cells << " cells, frame " << frame;
        lowest = std::min(lowest, middle[1]);
      }
      EXPECT_LT(lowest, 1.12) << "it has come to the cloth";
    }
  }
}

TEST(TouchingWorlds, AClothLiesOnAClothAtTheDistanceOfTheirLayer) {
  Played played(
      held_cloth(20) +
      "[[body]]\nname = \"upper\"\ncloth = { extent = [0.42, 0.42], cells = [8, 8], stretch = 400, bend = 2 }\n"
      "turn_deg = [-90, 10, 0]\nposition = [0.02, 1.03, 0.01]\ntotal_mass = 0.05\n");
  for (int frame = 0; frame < 45; ++frame) {
    played.play(frame, frame + 1);
    const Positions lower = played.places(0), upper = played.places(1);
    for (Eigen::Index v = 0; v < upper.rows(); ++v) {
      Eigen::Index below = 0;
      (lower.rowwise() - upper.row(v)).rowwise().squaredNorm().minCoeff(&below);
      EXPECT_GT(upper(v, 1), lower(below, 1) - 0.005) << frame << ": vertex " << v;
    }
  }
  EXPECT_FALSE(played.world.touches().empty());
}

// No vertex of one strip is over the other one: only their edges can hold it.
TEST(TouchingWorlds, EdgesOfClothsHoldEachOther) {
  const auto strip = [](const char* name, double turn_deg, const char* keys) {
    return fmt::format(
        "[[body]]\nname = \"{}\"\ncloth = {{ extent = [1, 0.05], cells = [4, 1], stretch = 400, bend = 2 }}\n"
        "turn_deg = [-90, {}, 0]\n{}\n",
        name, turn_deg, keys);
  };
  for (const double speed : {0.0, 3.0, 12.0}) {
    Played played(
        strip("held", 0,
              "position = [0, 1, 0]\ntotal_mass = 0.05\n"
              "[[body.handles]]\nname = \"a\"\nselect = { box = [[0, 0, 0], [0.01, 1, 1]] }\n"
              "[[body.handles]]\nname = \"b\"\nselect = { box = [[0.99, 0, 0], [1, 1, 1]] }") +
        strip("thrown", 90,
              fmt::format("position = [0.12, 1.1, 0.05]\ntotal_mass = 0.02\nvelocity = [0, {}, 0]", -speed).c_str()));
    played.play(0, 20);
    // The middle of the thrown one lies over the held one, and its ends hang down.
    const Positions thrown = played.places(1);
    EXPECT_GT(thrown.col(1).maxCoeff(), 0.8) << speed;
    EXPECT_LT(thrown.col(1).minCoeff(), 0.95) << speed;
  }
}

// The layers fall at one speed, and come near each other only because the ball stops the lowest one.
TEST(TouchingWorlds, LayersOfClothStayInTheirOrder) {
  std::string text =
      "[[collider]]\nname = \"ball\"\nshape = { sphere = { radius = 0.3 } }\nposition = [0, 0.35, 0]\nfriction = 0.4\n";
  for (int layer = 0; layer < 4; ++layer)
    text += fmt::format(
        "[[body]]\nname = \"cloth-{}\"\ncloth = {{ extent = [0.7, 0.7], cells = [9, 9], stretch = 400, bend = 2 }}\n"
        "turn_deg = [90, {}, 0]\nposition = [0, {}, 0]\ntotal_mass = 0.2\n",
        layer, 17 * layer, 0.8 + 0.05 * layer);
  Played played(text);
  for (int frame = 0; frame < 30; ++frame) {
    played.play(frame, frame + 1);
    std::vector<Positions> places;
    for (std::size_t b = 0; b < played.world.size(); ++b) places.push_back(played.places(b));
    EXPECT_TRUE(overlaps_of_bodies(played.world.bodies(), places).empty()) << frame;
  }
  EXPECT_FALSE(played.world.touches().empty());
}

// A strip of cloth whose end is folded over the rest, which is held, and let go.
std::string folded_strip(const char* self) {
  return fmt::format(
      "[[body]]\nname = \"strip\"\ncloth = {{ extent = [0.8, 0.2], cells = [20, 5], stretch = 400, bend = 0.5 }}\n"
      "position = [0, 0.5, 0]\nturn_deg = [90, 0, 0]\ntotal_mass = 0.1\ncontact = {{ self = {} }}\n"
      "[[body.handles]]\nname = \"table\"\nselect = {{ box = [[0, 0, 0], [0.45, 1, 1]] }}\n"
      "[[body.handles]]\nname = \"end\"\nselect = {{ box = [[0.98, 0, 0], [1, 1, 1]] }}\nuntil = 0.5\n"
      "stiffness = 300\nkeys = [{{ t = 0 }}, {{ t = 0.25, move = [-0.35, 0.3, 0] }},\n"
      "{{ t = 0.5, move = [-0.65, 0.1, 0] }}]\n",
      self);
}

// Returns the surface of the first body, at rest where it is now.
MovingSurface surface_now(const Played& played) {
  MovingSurface surface(played.world.body(0).model().surface, played.world.body(0).model().rest);
  surface.set_end(played.world.body(0).state().x);
  surface.set_start(played.world.body(0).state().x);
  return surface;
}

bool crosses_itself(const Played& played) {
  const MovingSurface surface = surface_now(played);
  return OwnSheet(surface, played.world.body(0).model().rest).crossing(surface, surface.start()).has_value();
}

TEST(TouchingWorlds, AClothTouchesItself) {
  Played played(folded_strip("true")), through(folded_strip("false"));
  int touches = 0, crossed = 0;
  for (int frame = 0; frame < 45; ++frame) {
    played.play(frame, frame + 1);
    through.play(frame, frame + 1);
    touches += !played.world.touches().empty();
    EXPECT_FALSE(crosses_itself(played)) << frame;
    crossed += crosses_itself(through);
  }
  EXPECT_GT(touches, 8);
  EXPECT_GT(crossed, 8) << "it would not have touched itself";
}

// A ring whose lowest and highest parts are held and moved towards each other until the one would be in the other.
std::string squeezed_ring(const char* self) {
  return no_gravity + fmt::format(
                          "[[body]]\nname = \"ring\"\nshape = \"shapes/ring.toml\"\nscale = 0.25\nvertices = 900\n"
                          "material = {{ model = \"stable-neo-hookean\", young = 2e5, poisson = 0.4 }}\n"
                          "contact = {{ self = {} }}\n"
                          "[[body.handles]]\nname = \"low\"\nselect = {{ box = [[0, 0, 0], [1, 0.04, 1]] }}\n"
                          "[[body.handles]]\nname = \"high\"\nselect = {{ box = [[0, 0.96, 0], [1, 1, 1]] }}\n"
                          "keys = [{{ t = 0 }}, {{ t = 1, move = [0, -0.32, 0] }}]\n",
                          self);
}

bool overlaps_itself(const Played& played) {
  const Model& model = played.world.body(0).model();
  MovingSurface surface = surface_now(played);
  return OwnSurface(tetrahedra_of(model), surface, model.rest, model.size).overlaps(surface, surface.start());
}

TEST(TouchingWorlds, ABodyTouchesItself) {
  Played played(squeezed_ring("true")), through(squeezed_ring("false"));
  int touches = 0;
  for (int frame = 0; frame < 36; ++frame) {
    played.play(frame, frame + 1);
    for (const BodyTouch& touch : played.world.touches()) {
      EXPECT_EQ(touch.a, touch.b);
      EXPECT_LT(touch.depth, 0.01 * played.world.body(0).model().size) << frame;
      ++touches;
    }
  }
  EXPECT_GT(touches, 8);
  EXPECT_TRUE(played.world.body(0).is_in_island());
  bool was_through = false;
  for (int frame = 0; frame < 36; ++frame) {
    through.play(frame, frame + 1);
    EXPECT_TRUE(through.world.touches().empty());
    was_through |= overlaps_itself(through);
  }
  EXPECT_TRUE(was_through) << "it would not have touched itself";
}

TEST(TouchingWorlds, ABodyThatTouchesItselfKeepsItsBits) {
  const std::string ring = squeezed_ring("true");
  Played whole(ring, 1), other(ring, 2), parts(ring);
  std::vector<WorldState> states;
  for (int frame = 0; frame < 34; ++frame) {
    whole.play(frame, frame + 1);
    states.push_back(whole.world.state());
  }
  other.play(0, 34);
  EXPECT_EQ(other.world.hash(), whole.world.hash());
  ASSERT_FALSE(whole.world.touches().empty());
  for (const int from : {31, 12, 28}) {
    parts.world.restore(states[from]);
    parts.play(from + 1, 34);
    EXPECT_EQ(parts.world.hash(), whole.world.hash()) << from;
  }
}

// Returns the keys of a handle that holds one side of a cube and moves it along x within a second.
std::string held_side(bool right, double move) {
  return fmt::format(
      "[[body.handles]]\nname = \"side\"\nselect = {{ box = [[{}, 0, 0], [{}, 1, 1]] }}\n"
      "keys = [{{ t = 0 }}, {{ t = 1, move = [{}, 0, 0] }}]\n",
      right ? 0.9 : 0, right ? 1 : 0.1, move);
}

// The first, fourth and fifth body press on each other, and the third one on the ring. Steps in which the ring comes
// through itself are made again: what they told of this pair is forgotten, and what the others' step told is kept.
TEST(TouchingWorlds, AStepThatIsMadeAgainForgetsItsOwnTouchesAlone) {
  std::string beside = cube("beside", 0.36, 0, held_side(true, -0.06));
  beside.replace(beside.find("0.5, 0]"), 7, "0.2, 0]");
  Played played(no_gravity + cube("first", 3, 0, held_side(false, 0)) +
                squeezed_ring("true").substr(no_gravity.size()) + beside + cube("fourth", 3.2, 0) +
                cube("fifth", 3.4, 0, held_side(true, -0.1)));
  int together = 0;
  for (int frame = 0; frame < 36; ++frame) {
    played.play(frame, frame + 1);
    std::vector<std::pair<std::size_t, std::size_t>> pairs;
    for (const BodyTouch& touch : played.world.touches()) pairs.emplace_back(touch.a, touch.b);
    EXPECT_EQ(std::ranges::adjacent_find(pairs), pairs.end()) << frame;
    const auto is_told = [&](std::size_t a, std::size_t b) { return std::ranges::count(pairs, std::pair(a, b)) == 1; };
    EXPECT_TRUE(frame < 10 || (is_told(0, 3) && is_told(3, 4))) << frame;
    together += is_told(1, 1) && is_told(1, 2);
  }
  EXPECT_GT(together, 0);
}

// Two of the cubes meet, the ring touches itself, and one cube is alone.
TEST(TouchingWorlds, BodiesThatStepAtTheSameTimeKeepTheirBits) {
  const std::string scene = squeezed_ring("true") + cube("left", 1, 0.4) + cube("right", 1.6, -0.4) +
                            cube("alone", 3, 1) + cube("also", 4, 0.5) + cube("last", 5, 0.2);
  Played one(scene, 1), two(scene, 2), four(scene, 4);
  int joined = 0;
  for (int frame = 0; frame < 34; ++frame) {
    std::vector<std::size_t> prepared, made;
    std::size_t most_waiting = 0;  // bodies whose inputs were known and whose steps were not
    ASSERT_TRUE(two.world.play(frame, {[&](std::size_t b, int) { prepared.push_back(b); },
                                       [&](std::size_t b, int) {
                                         most_waiting = std::max(most_waiting, prepared.size() - made.size());
                                         made.push_back(b);
                                       }}));
    EXPECT_GE(most_waiting, frame == 0 ? 2u : 1u);  // later on, the times of the steps decide
    for (std::vector<std::size_t>* told : {&prepared, &made}) {
      std::ranges::sort(*told);
      EXPECT_EQ(*told, (std::vector<std::size_t>{0, 1, 2, 3, 4, 5})) << frame;
    }
    one.play(frame, frame + 1);
    four.play(frame, frame + 1);
    joined += one.world.body(1).is_in_island();
    ASSERT_EQ(one.world.hash(), two.world.hash()) << frame;
    ASSERT_EQ(one.world.hash(), four.world.hash()) << frame;
  }
  EXPECT_TRUE(one.world.body(0).is_in_island());
  EXPECT_GT(joined, 0);
  EXPECT_LT(joined, 34);
}

TEST(TouchingWorlds, AStepThatFailsBesideOthersIsTold) {
  std::string wild = cube("wild", 3, 0,
                          "[body.solver]\nline_search = \"none\"\nlevels = 1\n[[body.handles]]\nname = \"hook\"\n"
                          "select = { box = [[0, 0, 0], [0.1, 1, 1]] }\n");
  const std::size_t material = wild.find("model = ");
  wild.replace(material, wild.find(" }", material) - material, "model = \"polynomial\", mu = 1e9");
  const std::string scene = "gravity = [0, -2000, 0]\n" + cube("sound", 0, 0) + wild + cube("other", 6, 0);
  std::vector<int> failed_in;
  for (const int threads : {1, 2}) {
    Played played(scene, threads);
    std::vector<std::size_t> made;
    int frame = 0;
    while (frame < 200 && played.world.play(frame, {{}, [&](std::size_t b, int) { made.push_back(b); }})) ++frame;
    EXPECT_TRUE(played.world.body(1).report().failed);
    EXPECT_EQ(made.back(), 1u);
    failed_in.push_back(frame);
  }
  EXPECT_LT(failed_in[0], 200);
  EXPECT_EQ(failed_in[0], failed_in[1]);
}

TEST(TouchingWorlds, ABodyThatDoesNotTouchItselfMakesItsOwnStep) {
  std::string apart = squeezed_ring("true");
  apart.replace(apart.find("-0.32"), 5, "-0.10");
  std::string without = squeezed_ring("false");
  without.replace(without.find("-0.32"), 5, "-0.10");
  Played one(apart), other(without);
  one.play(0, 15);
  other.play(0, 15);
  EXPECT_FALSE(one.world.body(0).is_in_island());
  EXPECT_EQ(one.world.hash(), other.world.hash());
}

}  // namespace touching_worlds_test
}  // namespace supple
