// Tests the reference for steps that bodies make together: errors against it fall with more iterations, it is asked for
// once for all bodies of an island, and nothing that it does changes the world.
#include "baselines/joined_reference.h"

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "app/solvers.h"
#include "film/record/world_errors.h"
#include "support/scene_text.h"

namespace supple {
namespace joined_reference_test {

std::string cube(const std::string& name, double height, const std::string& keys = "") {
  return fmt::format(
      "[[body]]\nname = \"{}\"\nbox = {{ extent = [0.2, 0.2, 0.2], cells = [4, 4, 4] }}\nposition = [0, {}, 0]\n"
      "material = {{ model = \"stable-neo-hookean\", young = 1e5, poisson = 0.4 }}\n{}\n",
      name, height, keys);
}

const std::string ground = "[[collider]]\nshape = { half_space = { normal = [0, 1, 0] } }\nfriction = 0.5\n";

// A cube falls on another one that lies on the ground; a third cube is far above both.
std::string drop(int iterations) {
  return fmt::format("[solver]\niterations = {}\nrounds = 1\n", iterations) + cube("low", 0.001) +
         cube("high", 0.23, "velocity = [0, -1, 0]\nturn_deg = [4, 20, 7]") + cube("apart", 3) + ground;
}

// Plays a scene and measures its steps.
struct Measured {
  explicit Measured(const std::string& text)
      : world(test::scene_of(text), assemble(test::scene_of(text))), errors(world, solvers, threads) {
    world.start(solvers.steps, &threads);
    solvers.joined_errors = [this, measure = solvers.joined_errors](auto&... step) {
      ++joined_calls;
      return measure(step...);
    };
  }
  // Plays a frame, and returns the errors of its last step by body.
  std::vector<std::optional<MeasuredErrors>> play(int frame) {
    std::vector<std::optional<MeasuredErrors>> found(world.size());
    EXPECT_TRUE(world.play(frame, {[this](std::size_t body, int) { errors.before_step(body); },
                                   [&](std::size_t body, int) { found[body] = errors.of_step(body); }}));
    return found;
  }

  Threads threads{1};
  FilmSolvers solvers = all_solvers();
  int joined_calls = 0;
  World world;
  WorldErrors errors;
};

constexpr int touching = 1;  // a frame in which the upper cube presses the lower one

WorldState state_before_touching() {
  Measured played(drop(10));
  for (int frame = 0; frame < touching; ++frame) EXPECT_TRUE(played.world.play(frame));
  return played.world.state();
}

TEST(JoinedReference, ErrorsFallWithMoreIterations) {
  const WorldState start = state_before_touching();
  std::vector<double> energy, motion;
  for (const int iterations : {2, 10, 100}) {
    Measured measured(drop(iterations));
    measured.world.restore(start);
    const auto found = measured.play(touching);
    ASSERT_TRUE(measured.world.body(0).is_in_island() && measured.world.body(1).is_in_island());
    ASSERT_TRUE(found[0] && found[1]);
    EXPECT_TRUE(found[0]->converged);
    ASSERT_TRUE(found[0]->error);
    EXPECT_GE(*found[0]->error, 0);
    EXPECT_EQ(found[0]->error, found[1]->error) << "the error of equation 12 is that of the island";
    energy.push_back(*found[0]->error);
    motion.push_back(std::max(found[0]->motion, found[1]->motion));
  }
  EXPECT_LT(energy[1], energy[0]);
  EXPECT_LT(motion[1], motion[0]);
  EXPECT_LT(energy[2], 0.01 * energy[0]);
  EXPECT_LT(motion[2], 0.1 * motion[0]);
}

TEST(JoinedReference, IsAskedForOnceForAllBodiesOfAnIsland) {
  Measured measured(drop(10));
  measured.world.restore(state_before_touching());
  const auto found = measured.play(touching);
  EXPECT_EQ(measured.joined_calls, 1);
  ASSERT_TRUE(found[0] && found[1]);
  EXPECT_NE(found[0]->motion, found[1]->motion) << "each body has its own error of motion";
  EXPECT_FALSE(measured.world.body(2).is_in_island());
  EXPECT_TRUE(found[2]) << "a body alone has its own reference";
}

TEST(JoinedReference, ChangesNoBitsOfTheMotion) {
  Measured measured(drop(10));
  Measured plain(drop(10));
  for (int frame = 0; frame < 8; ++frame) {
    measured.play(frame);
    ASSERT_TRUE(plain.world.play(frame));
    EXPECT_EQ(measured.world.hash(), plain.world.hash()) << frame;
  }
  EXPECT_GT(measured.joined_calls, 0);
}

}  // namespace joined_reference_test
}  // namespace supple
