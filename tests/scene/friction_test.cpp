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

// With friction f, the next iterate asks for 2 - s (f - 1), whose fixed point is where f = (2 + s) / (1 + s).
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
  EXPECT_LT(left_after(20, 2), 1e-9);
  EXPECT_LT(left_after(60, 0.5), 1e-9);
  EXPECT_LT(left_after(60, -0.5), 1e-9);  // this does not swing
}

TEST(Friction, IsEasedOnlyWhereItTurnsBack) {
  std::vector<Contact> before = {contact_of(2, 1), contact_of(5, 1)};
  before[0].friction_change = before[1].friction_change = 1;
  std::vector<Contact> next = {contact_of(2, 3), contact_of(4, 1), contact_of(5, 0)};
  ease_friction(before, next);
  EXPECT_EQ(next[0].friction, 3);
  EXPECT_EQ(next[0].friction_change, 2);
  EXPECT_EQ(next[1].friction, 1);
  EXPECT_EQ(next[1].friction_change, 1);
  EXPECT_EQ(next[2].friction, 0.5);
  EXPECT_EQ(next[2].friction_change, 0);
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
