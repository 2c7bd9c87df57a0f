// Tests the balance of energy of bodies that push each other: none gains from nothing where it is stopped, and what one
// gives is what the other gets.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include "support/bodies.h"
#include "support/energy_watch.h"
#include "support/played_world.h"
#include "support/scene_text.h"

namespace supple {
namespace meeting_energy_test {

World world_of(const std::string& text) {
  World world(test::scene_of(text), assemble(test::scene_of(text)));
  world.start({make_rule, settings_of}, nullptr);
  return world;
}

std::string towel(const std::string& name, double turn_deg, double height) {
  return fmt::format(
      "[[body]]\nname = \"{}\"\ncloth = {{ extent = [0.7, 0.7], cells = [30, 30] }}\nmaterial = \"cotton\"\n"
      "density = 0.4\nturn_deg = [-90, {:g}, 0]\nposition = [0, {:g}, 0]\n",
      name, turn_deg, height);
}

// The contacts are far stiffer than the cloth, and ten iterations leave them with forces that are several times as
// large as those that stop the towel.
TEST(MeetingEnergy, ATowelThatFallsOnAnotherOneGainsNothingFromNothing) {
  World world = world_of("frames = 8\n" + towel("lower", 10, 0.05) + towel("upper", 35, 0.2) +
                         "[[collider]]\nname = \"ground\"\nshape = { half_space = { normal = [0, 1, 0] } }\n"
                         "friction = 0.6\nthickness = 0.004\n");
  double put_in = 0;
  EXPECT_LT(test::share_from_nothing(world, 8, put_in), 0.01) << put_in;
}

std::string cube(const std::string& name, double x, double speed) {
  return fmt::format(
      "[[body]]\nname = \"{}\"\nbox = {{ extent = [0.2, 0.2, 0.2], cells = [4, 4, 4] }}\n"
      "material = {{ model = \"stable-neo-hookean\", young = 1e5, poisson = 0.4 }}\ndensity = 1000\n"
      "position = [{:g}, 0, 0]\nvelocity = [{:g}, 0, 0]\n",
      name, x, speed);
}

// Returns what was put into the first and into the second cube.
std::array<double, 2> put_into_cubes(double first_speed, double second_speed) {
  const std::string first = cube("first", -0.11, first_speed), second = cube("second", 0.11, second_speed);
  std::array<double, 2> given{};
  for (int k = 0; k < 2; ++k) {
    World world = world_of("frames = 20\ngravity = [0, 0, 0]\n" + (k == 0 ? first + second : second + first));
    EXPECT_LT(test::share_from_nothing(world, 20, given[k]), 1e-3);
  }
  return given;
}

TEST(MeetingEnergy, WhatACubeGivesIsWhatTheOtherOneGets) {
  const double kinetic = 0.5 * 8 * 2 * 2;
  const auto [first, second] = put_into_cubes(2, 0);
  EXPECT_GT(second, 0.3 * kinetic);
  EXPECT_LT(second, kinetic);
  EXPECT_NEAR(first + second, 0, 0.1 * kinetic) << first << " " << second;
}

TEST(MeetingEnergy, CubesThatMeetHeadOnGiveEachOtherNothing) {
  const double kinetic = 0.5 * 8 * 2 * 2;
  const auto [first, second] = put_into_cubes(2, -2);
  EXPECT_NEAR(first, 0, 0.02 * kinetic);
  EXPECT_NEAR(second, 0, 0.02 * kinetic);
}

}  // namespace meeting_energy_test
}  // namespace supple
