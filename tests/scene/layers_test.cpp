// Tests that cloth in layers comes to rest where it lies.
#include <gtest/gtest.h>

#include "support/played_world.h"

namespace supple {
namespace layers_test {

std::string towel(const std::string& name, double height, double turn) {
  return fmt::format(
      "[[body]]\nname = \"{}\"\ncloth = {{ extent = [0.3, 0.3], cells = [18, 18] }}\nmaterial = \"cotton\"\n"
      "density = 0.4\nturn_deg = [-90, {}, 0]\nposition = [0, {}, 0]\n",
      name, turn, height);
}
const std::string three = towel("first", 0.008, 10) + towel("second", 0.03, 35) + towel("third", 0.05, -20) +
                          "[[collider]]\nname = \"ground\"\nshape = { half_space = { normal = [0, 1, 0] } }\n"
                          "friction = 0.5\nthickness = 0.002\n";

TEST(Layers, ComeToRest) {
  test::PlayedWorld played(three);
  played.play(0, 85);
  const auto positions = [&](std::size_t body) { return played.places(body); };
  const std::vector<Positions> before = {positions(0), positions(1), positions(2)};
  played.play(85, 87);
  for (std::size_t body = 0; body < 3; ++body) {
    const StepReport& report = played.world.body(body).report();
    EXPECT_EQ(report.stop_reason, StopReason::still) << body;
    EXPECT_LT(report.motion_estimate, 0.03) << body;
    EXPECT_LT(report.error_estimate, 1e-6) << body;
    EXPECT_GT(report.contacts.touching, 200) << body;
    EXPECT_LT((positions(body) - before[body]).rowwise().norm().maxCoeff(), 1e-6 * 0.3) << body;
  }
}

// With all iterations, the towels lie where they lie still, as nearly as films part that differ by a micrometre (1 %).
TEST(Layers, LieWhereAllIterationsLeaveThem) {
  test::PlayedWorld played(three), all("solver = { still = 0 }\n" + three);
  played.play(0, 85);
  all.play(0, 85);
  for (std::size_t body = 0; body < 3; ++body) {
    const double apart = (played.places(body) - all.places(body)).rowwise().norm().maxCoeff();
    EXPECT_LT(apart, 0.02 * 0.3 * std::sqrt(2)) << body;
    EXPECT_EQ(played.world.body(body).report().iterations, 0) << body;
    EXPECT_GE(all.world.body(body).report().iterations, 1) << body;
  }
}

TEST(Layers, HaveTheSameBitsOnAnyNumberOfThreads) {
  test::PlayedWorld one(three), two(three, 2);
  one.play(0, 45);
  two.play(0, 45);
  for (std::size_t body = 0; body < 3; ++body) EXPECT_EQ(one.places(body), two.places(body)) << body;
}

}  // namespace layers_test
}  // namespace supple
