// Tests edges that touch edges of a solid: cloth that hangs over a ridge between its vertices, cubes that lie across
// each other, and what begins a film on the wrong side.
#include <gtest/gtest.h>

#include <algorithm>

#include "geometry/triangles/edge_crossings.h"
#include "support/played_world.h"

namespace supple {
namespace touching_edges_test {

using Played = test::PlayedWorld;

// Counts edges that pass through triangles of the other one of two bodies.
std::int64_t crossings(const Played& played) {
  const Model &one = played.world.body(0).model(), &other = played.world.body(1).model();
  Positions x(one.vertices + other.vertices, 3);
  x << played.world.body(0).state().x, played.world.body(1).state().x;
  Triangles triangles(one.surface.rows() + other.surface.rows(), 3);
  triangles << one.surface, other.surface.array() + one.vertices;
  return EdgeCrossings(triangles, x).count(x).apart;
}

const std::string no_gravity = "gravity = [0, 0, 0]\n";
constexpr double ridge = 1.05;  // the height of the bar's upper edge [m]

const std::string stiff =
    "material = { model = \"stable-neo-hookean\", young = 1e8, poisson = 0.3 }\ndensity = 100\n"
    "[[body.handles]]\nname = \"left\"\nselect = { box = [[0, 0, 0], [0.01, 1, 1]] }\n"
    "[[body.handles]]\nname = \"right\"\nselect = { box = [[0.99, 0, 0], [1, 1, 1]] }\n";

// A bar along x that is held at both ends, one of whose edges is up. It has no vertices near the strip.
const std::string bar =
    "[[body]]\nname = \"bar\"\nbox = { extent = [1, 0.0707107, 0.0707107], cells = [2, 1, 1] }\n"
    "turn_deg = [45, 0, 0]\nposition = [0, 0.95, 0]\n" +
    stiff;

// A strip of cloth along z. The bar is between its vertices.
std::string strip(double height, double speed) {
  return fmt::format(
      "[[body]]\nname = \"strip\"\ncloth = {{ extent = [1, 0.05], cells = [4, 1], stretch = 400, bend = 2 }}\n"
      "turn_deg = [-90, 90, 0]\nposition = [0.12, {}, 0.1]\ntotal_mass = 0.02\nvelocity = [0, {}, 0]\n",
      height, speed);
}

// Returns the height of the strip above the bar's middle.
double height_over_bar(const Played& played) {
  const Positions cloth = played.places(1);
  double height = -1;
  for (Eigen::Index a = 0; a < cloth.rows(); ++a) {
    for (Eigen::Index b = 0; b < cloth.rows(); ++b) {
      const double from = cloth(a, 2), to = cloth(b, 2);
      if (from >= 0 || to < 0 || to - from > 0.26) continue;
      height = std::max(height, cloth(a, 1) + from / (from - to) * (cloth(b, 1) - cloth(a, 1)));
    }
  }
  return height;
}

TEST(TouchingEdges, HoldAStripOfClothOverABar) {
  for (const double speed : {0.0, 3.0, 12.0}) {  // [m/s]
    Played played(bar + strip(1.1, -speed));
    for (int frame = 0; frame < 15; ++frame) {
      played.play(frame, frame + 1);
      EXPECT_GT(height_over_bar(played), ridge - 0.005) << speed << " m/s, frame " << frame;
      EXPECT_EQ(crossings(played), 0) << speed << " m/s, frame " << frame;
    }
    EXPECT_LT(played.places(1).col(1).minCoeff(), 1) << "its ends hang down";
  }
}

TEST(TouchingEdges, ThatBeginBelowARidgeComeOut) {
  Played played(no_gravity + bar + strip(ridge - 0.02, 0));
  ASSERT_GT(crossings(played), 0);
  played.play(0, 30);
  EXPECT_EQ(crossings(played), 0);
  EXPECT_GT(height_over_bar(played), ridge);
}

// The lower cube's foot is held, and its upper edge is up; the edge of the other cube falls across it. No vertex of the
// one comes into the other.
TEST(TouchingEdges, OfTwoCubesHoldThemAcrossEachOther) {
  const auto cube = [](const char* name, double size, const char* keys) {
    return fmt::format(
        "[[body]]\nname = \"{0}\"\nbox = {{ extent = [{1}, {1}, {1}], cells = [3, 3, 3] }}\nmaterial = "
        "\"rubber\"\n{2}\n",
        name, size, keys);
  };
  Played played(cube("low", 0.3,
                     "turn_deg = [0, 0, 45]\nposition = [0, 0, 0]\n"
                     "[[body.handles]]\nname = \"foot\"\nselect = { box = [[0, 0, 0], [0.34, 1, 1]] }") +
                cube("high", 0.31, "turn_deg = [45, 0, 0]\nposition = [0.013, 0.45, 0.017]"));
  for (int frame = 0; frame < 8; ++frame) {
    played.play(frame, frame + 1);
    const double top = played.places(0).col(1).maxCoeff(), bottom = played.places(1).col(1).minCoeff();
    EXPECT_GT(bottom, top - 0.02) << frame;
  }
  EXPECT_FALSE(played.world.touches().empty());
}

// The ball is thrown by its own size in a frame.
const std::string thrown_ball =
    "[[body]]\nname = \"cloth\"\ncloth = { extent = [1, 1], cells = [40, 40] }\nmaterial = \"cotton\"\n"
    "position = [0, 0.5, 0]\n"
    "[[body.handles]]\nname = \"left\"\nselect = { box = [[0, 1, 0], [0, 1, 1]] }\n"
    "[[body.handles]]\nname = \"right\"\nselect = { box = [[1, 1, 0], [1, 1, 1]] }\n"
    "[[body]]\nname = \"ball\"\nshape = \"shapes/sphere.toml\"\nsize = 0.2\nvertices = 500\nmaterial = \"rubber\"\n"
    "position = [0, 1.1, 0.5]\nvelocity = [0, 0, -6]\n";

TEST(TouchingEdges, KeepASoftBallOnItsSideOfACloth) {
  Played played(thrown_ball);
  int crossed = 0;
  for (int frame = 0; frame < 40; ++frame) {
    played.play(frame, frame + 1);
    crossed += crossings(played) > 0;
  }
  EXPECT_LE(crossed, 1) << "frames; there are 32 where only vertices touch, and stay where they come through";
}

TEST(TouchingEdges, HaveTheSameBitsForAllThreadsAndGoOnFromAnyState) {
  Played one(thrown_ball, 1), two(thrown_ball, 2), later(thrown_ball, 1);
  one.play(0, 5);
  const WorldState middle = one.world.state();
  one.play(5, 8);
  two.play(0, 8);
  later.world.restore(middle);
  later.play(5, 8);
  EXPECT_EQ(one.world.hash(), two.world.hash());
  EXPECT_EQ(one.world.hash(), later.world.hash());
}

// A corner of a cube begins the film below a cloth that is held, and the cube above it.
TEST(TouchingEdges, ACornerThatBeginsBeyondAClothComesBack) {
  Played played(
      no_gravity +
      "[[body]]\nname = \"cloth\"\ncloth = { extent = [1, 1], cells = [4, 4] }\nmaterial = \"cotton\"\n"
      "turn_deg = [-90, 0, 0]\nposition = [0, 1, 0]\n"
      "[[body.handles]]\nname = \"border\"\nselect = { border = true }\n"
      "[[body]]\nname = \"cube\"\nbox = { extent = [0.2, 0.2, 0.2], cells = [1, 1, 1] }\nmaterial = \"rubber\"\n"
      "turn_deg = [45, 0, 35.26]\nposition = [0.08, 0.99, 0.06]\n");
  ASSERT_GT(crossings(played), 0);
  played.play(0, 30);
  EXPECT_EQ(crossings(played), 0);
  EXPECT_GT(played.places(1).col(1).mean(), 1.1) << "above the cloth";
}

}  // namespace touching_edges_test
}  // namespace supple
