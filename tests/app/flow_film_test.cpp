// Tests films of bodies that keep dents or creep, as a user makes them: what their profiles say, that a resumed film is
// the same, and what is refused.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "support/bodies.h"
#include "support/program.h"

namespace supple {
namespace flow_film_test {

using test::run;

class FlowFilm : public testing::Test {
 protected:
  void SetUp() override {
    std::ofstream(folder_.path / "drop.toml") << R"(frames = 12
fps = 60
[[body]]
name = "tin"
box = { extent = [0.2, 0.2, 0.2], cells = [3, 3, 3] }
velocity = [0, -3, 0]
material = { model = "neo-hookean", young = 2e5, poisson = 0.3 }
plastic = { yield = 4e3 }
[[body]]
name = "rubber"
box = { extent = [0.2, 0.2, 0.2], cells = [3, 3, 3] }
position = [0.4, 0, 0]
velocity = [0, -3, 0]
material = { model = "neo-hookean", young = 2e5, poisson = 0.3 }
[[collider]]
shape = { half_space = { normal = [0, 1, 0] } }
)";
  }
  std::vector<std::string> film(const std::string& out, const std::vector<std::string>& more = {}) {
    std::vector<std::string> arguments = {"render", "drop.toml", "--no-images", "--quiet", "--out", out};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  test::TemporaryFolder folder_;
};

TEST_F(FlowFilm, ProfilesTellWhatFlowedAwayAlsoOfAResumedFilm) {
  ASSERT_EQ(run(folder_.path, film("whole")).status, 0);
  ASSERT_EQ(run(folder_.path, film("cut", {"--frames", "5", "--checkpoint-every", "1"})).status, 0);
  ASSERT_EQ(run(folder_.path, film("cut", {"--resume"})).status, 0);
  const auto whole = test::profile_of(folder_.path / "whole"), cut = test::profile_of(folder_.path / "cut");
  double lost = 0;
  for (std::size_t f = 0; f < 12; ++f) {
    const auto &frame = whole["frames"][f], &tin = frame["bodies"][0]["energy"];
    EXPECT_EQ(frame["state_hash"], cut["frames"][f]["state_hash"]) << f;
    EXPECT_EQ(tin, cut["frames"][f]["bodies"][0]["energy"]) << f;
    EXPECT_GE(tin["lost_to_flow"], lost);
    lost = tin["lost_to_flow"];
    EXPECT_LE(tin["from_nothing"], 1e-3 * tin["exchanged"].get<double>());
    EXPECT_FALSE(frame["bodies"][1]["energy"].contains("lost_to_flow"));
  }
  EXPECT_GT(lost, 1);
}

TEST_F(FlowFilm, WhatPositionsAndStatesDoNotTellIsRefused) {
  const test::Result states = run(folder_.path, film("a", {"--save-state", "2"}));
  EXPECT_EQ(states.status, 2);
  EXPECT_NE(states.err.find("'tin' keeps dents or creeps"), std::string::npos) << states.err;
  const test::Result info = run(folder_.path, {"info", "drop.toml"});
  EXPECT_NE(info.out.find("keeps strains above a stress of 4000 Pa"), std::string::npos) << info.out;
}

}  // namespace flow_film_test
}  // namespace supple
