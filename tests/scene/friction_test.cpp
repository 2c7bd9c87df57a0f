// Tests that friction which follows from the depths of iterates comes to rest.
#include <gtest/gtest.h>

#include <cmath>

#include "sim/contact/lagged_friction.h"
#include "support/played_world.h"

namespace supple {
namespace friction_test {

Contact contact_of(std::int32_t number, double friction) {
  Contact contact{};
  contact.number = number;
  contact.other.collider = 0;
  contact.friction = friction;
  return contact;
}

// Returns how far friction is from where it would stay after some iterates. With friction f, the next iterate asks for
// 2 - s (f - 1), which stays at f = (2 + s) / (1 + s).
double left_after(int iterates, double s) {
  std::vector<Contact> now = {contact_of(7, 0)};
  for (int i = 0; i < iterates; ++i) {
    std::vector<Contact> next = {contact_of(3, 1), contact_of(7, 2 - s * (now.back().friction - 1))};
    ease_friction(now, next);
    now = next;
  }
  return std::abs(now.back().friction - (2 + s) / (1 + s));
}

TEST(Friction, ComesToRestWhereItWouldSwing) {
  EXPECT_LT(left_after(20, 0.99), 1e-9);
  EXPECT_LT(left_after(20, 1.5), 1e-9);
  EXPECT_LT(left_after(60, 0.4), 1e-9);   // this swings, and comes to rest by itself
  EXPECT_LT(left_after(60, -0.5), 1e-9);  // this does not swing
}

TEST(Friction, IsEasedOnlyWhereItGoesOnSwinging) {
  const auto after = [](double last, int swings, double asked) {
    std::vector<Contact> before = {contact_of(5, 1)}, next = {contact_of(4, 7), contact_of(5, asked)};
    before[0].friction_change = last;
    before[0].friction_swings = swings;
    ease_friction(before, next);
    EXPECT_EQ(next[0].friction, 7);
    EXPECT_EQ(next[0].friction_change, 7);
    return next[1];
  };
  EXPECT_EQ(after(1, 1, 0).friction, 0.5);
  EXPECT_EQ(after(1, 1, 0).friction_change, 0);
  EXPECT_EQ(after(1, 0, 0).friction, 0);
  EXPECT_EQ(after(1, 0, 0).friction_swings, 1);
  EXPECT_EQ(after(1, 1, 0.6).friction, 0.6);  // turns back less than half
  EXPECT_EQ(after(1, 1, 0.6).friction_swings, 0);
  EXPECT_EQ(after(1, 1, 3).friction, 3);
  EXPECT_EQ(after(1, 1, 3).friction_change, 2);
}

// An edge of a solid that touches others has the number of its first vertex, which may touch something itself.
TEST(Friction, IsEasedBesideThatOfTheSameEdges) {
  const auto between_edges = [](std::int32_t last, double friction) {
    Contact contact = contact_of(5, friction);
    contact.other = {.collider = -1, .part = 0};
    contact.stencil = {{5, 6, 20, last}, {0.5, 0.5, -0.3, -0.7}, 4, 4};
    return contact;
  };
  Contact of_vertex = contact_of(5, 3);
  of_vertex.other = {.collider = -1, .part = 0};
  std::vector<Contact> before = {of_vertex, between_edges(21, 1), between_edges(22, 2)};
  before[2].friction_change = 1;
  before[2].friction_swings = 1;
  std::vector<Contact> next = {between_edges(22, 1), between_edges(21, 4), of_vertex, between_edges(23, 8)};
  ease_friction(before, next);
  EXPECT_EQ(next[0].friction, 1.5);
  EXPECT_EQ(next[1].friction_change, 3);
  EXPECT_EQ(next[2].friction_change, 0);
  EXPECT_EQ(next[3].friction_change, 8);  // it is new
}

// The ball slides onto the ground and begins to roll; in its second step, the friction of a vertex that arrives swings.
TEST(Friction, DoesNotSwingUnderABallThatBeginsToRoll) {
  test::PlayedWorld played(
      "[solver]\niterations = 200\n"
      "[[body]]\nshape = \"shapes/sphere.toml\"\nscale = 0.1\nvertices = 300\nvelocity = [1, 0, 0]\n"
      "material = \"rubber\"\n"
      "[[collider]]\nshape = { half_space = { normal = [0, 1, 0] } }\nfriction = 0.5\n");
  for (int frame = 0; frame < 12; ++frame) {
    ASSERT_TRUE(played.world.play(frame));
    const StepReport& report = played.world.body(0).report();
    EXPECT_LT(report.iterations, 150) << frame;
    EXPECT_LT(report.motion_estimate, 1e-4) << frame;
  }
}

}  // namespace friction_test
}  // namespace supple
