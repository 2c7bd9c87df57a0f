// A run tells how bodies that meet touched each other, and warns of those that were deep in each other.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>

#include "support/bodies.h"
#include "support/program.h"

namespace supple {
namespace touching_bodies_test {

using nlohmann::json;
using test::Result;

class TouchingBodies : public testing::Test {
 protected:
  // Films a scene, or a replay of it. Its result is in the folder `film`.
  Result film(const std::string& scene, std::vector<std::string> more = {}, const std::string& replay = "") {
    std::ofstream(folder_.path / "scene.toml") << scene;
    std::ofstream(folder_.path / "replay.toml") << "scene = \"scene.toml\"\n" << replay;
    std::vector<std::string> arguments = {"render", "scene.toml"};
    if (!replay.empty()) arguments = {"replay", "replay.toml"};
    more.insert(more.begin(), {"--no-images", "--force", "--out", "film"});
    arguments.insert(arguments.end(), more.begin(), more.end());
    Result result = test::run(folder_.path, arguments);
    EXPECT_EQ(result.status, 0) << result.err;
    return result;
  }
  json profile() const { return test::profile_of(folder_.path / "film"); }
  // Returns the frames whose rows have a key.
  std::vector<int> frames_with(const char* key) const {
    const json whole = profile();
    std::vector<int> frames;
    for (const json& frame : whole["frames"]) {
      if (frame.contains(key)) frames.push_back(frame["frame"]);
    }
    return frames;
  }
  // Returns how many of the run's warnings are of bodies that are deep in each other.
  int warnings_of_depth() const {
    const json whole = profile();
    return static_cast<int>(std::ranges::count_if(whole["summary"]["warnings"], [](const json& warning) {
      return warning.get<std::string>().find("deep in each other") != std::string::npos;
    }));
  }

  std::vector<std::string> hashes() const {
    const json whole = profile();
    std::vector<std::string> list;
    for (const json& frame : whole["frames"]) list.push_back(frame["state_hash"]);
    return list;
  }

  test::TemporaryFolder folder_;
};

std::string cube(const std::string& name, const std::string& more) {
  return fmt::format(
      "[[body]]\nname = \"{}\"\nbox = {{ extent = [0.2, 0.2, 0.2], cells = [3, 3, 3] }}\nmaterial = \"rubber\"\n{}\n",
      name, more);
}

const std::string in_place = "gravity = [0, 0, 0]\n";
const std::string ground = "[[collider]]\nshape = { half_space = { normal = [0, 1, 0] } }\n";
const std::string names = R"(["lower", "upper"])";

// Forces do not follow from positions, so that a drawing needs what the run kept of them.
TEST_F(TouchingBodies, KeepTheirForcesForDrawingsWhereThereIsNoCollider) {
  const auto bytes_of_forces = [&](const std::string& position) {
    film("frames = 8\n" + in_place + cube("left", "velocity = [1, 0, 0]") + cube("right", position));
    const Result drawn = test::run(folder_.path, {"draw", "film", "--frame", "5", "--still", "forces.png", "--field",
                                                  "force", "--set", "output.width=160", "--set", "output.height=90"});
    EXPECT_EQ(drawn.status, 0) << drawn.err;
    return std::filesystem::file_size(folder_.path / "film" / "motion" / "left.forces");
  };
  const auto touched = bytes_of_forces("position = [0.25, 0, 0]"), apart = bytes_of_forces("position = [3, 0, 0]");
  EXPECT_GT(touched, apart);
}

TEST_F(TouchingBodies, HaveRowsInTheFramesInWhichTheyTouch) {
  const Result result =
      film("frames = 12\n" + cube("lower", "") + cube("upper", "position = [0.02, 0.25, 0.03]") + ground);
  const std::vector<int> frames = frames_with("pairs");
  ASSERT_FALSE(frames.empty());
  EXPECT_GT(frames.front(), 0) << "the upper cube falls 0.05 m";
  const json whole = profile();
  double largest_force = 0;
  for (const int frame : frames) {
    const json& pairs = whole["frames"][std::size_t(frame)]["pairs"];
    ASSERT_EQ(pairs.size(), 1u);
    EXPECT_EQ(pairs[0]["bodies"], json::parse(names));
    EXPECT_GT(pairs[0]["contacts"], 0);
    EXPECT_GE(pairs[0]["penetration"], 0.0);
    EXPECT_FALSE(pairs[0].contains("expected"));
    largest_force = std::max(largest_force, pairs[0]["force"].get<double>());
  }
  EXPECT_GT(largest_force, 0);
  EXPECT_NE(result.out.find("body          other body      penetration  at frame"), std::string::npos) << result.out;
}

TEST_F(TouchingBodies, HaveMeasuredErrorsThatChangeNoBits) {
  const std::string scene =
      "frames = 6\n" + cube("lower", "") + cube("upper", "position = [0.02, 0.25, 0.03]") + ground;
  film(scene);
  const std::vector<std::string> plain = hashes();
  film(scene, {"--error-every", "2"});
  EXPECT_EQ(hashes(), plain);
  const json whole = profile();
  for (std::size_t frame = 0; frame < plain.size(); ++frame) {
    for (const json& body : whole["frames"][frame]["bodies"]) {
      EXPECT_EQ(body.contains("error"), frame % 2 == 0) << frame;
      EXPECT_EQ(body.contains("motion_error"), frame % 2 == 0) << frame;
    }
  }
}

// A cloth that falls over two cubes and onto itself, while friction and stiffness change.
const std::string covered =
    "frames = 36\n" + cube("lower", "") + cube("upper", "position = [0.02, 0.25, 0.03]") + ground +
    "[[body]]\nname = \"cloth\"\ncloth = { extent = [0.8, 0.5], cells = [20, 12], stretch = 200, bend = 0.5 }\n"
    "turn_deg = [80, 15, 0]\nposition = [0, 0.6, 0]\ntotal_mass = 0.1\n";
std::string change(const char* path, double at, const char* to) {
  return fmt::format("[[change]]\nt = {}\npath = \"{}\"\nvalue = {}\n", at, path, to);
}
const std::string changes =
    change("body.cloth.contact.friction", 0.3, "0.1") + change("body.cloth.cloth.stretch", 0.5, "60") +
    change("body.upper.contact.friction", 0.5, "0.9") + change("body.cloth.contact.self", 0.7, "false") +
    change("body.cloth.contact.self", 0.8, "true") + change("body.upper.contact.meets", 0.9, "false");

TEST_F(TouchingBodies, HaveTheSameBitsForAllThreadsWithPicturesAndAfterTwentyKills) {
  film(covered, {"--no-video", "--threads", "1"}, changes);
  const std::vector<std::string> whole = hashes();
  ASSERT_EQ(whole.size(), 36u);
  for (const char* threads : {"2", "4"}) {
    film(covered, {"--no-video", "--threads", threads}, changes);
    EXPECT_EQ(hashes(), whole) << threads;
  }
  film(covered, {"--set", "output.width=160", "--set", "output.height=90"}, changes);
  EXPECT_EQ(hashes(), whole);
  std::mt19937 dice(3);
  std::filesystem::remove_all(folder_.path / "film");
  std::vector<std::string> arguments = {"replay", "replay.toml", "--no-images", "--no-video", "--checkpoint-every",
                                        "1",      "--out",       "film"};
  const std::vector<std::string> first = arguments;
  arguments.push_back("--resume");
  int kills = 0, ends = 0;
  while (kills < 20) {
    const bool is_begun = std::filesystem::exists(folder_.path / "film" / "run.json");
    const Result result = test::run_and_kill(folder_.path, is_begun ? arguments : first, 60 + int(dice() % 200));
    ASSERT_TRUE(result.status == 0 || result.status == -SIGKILL) << result.err;
    kills += result.status < 0;
    if (result.status != 0) continue;
    EXPECT_EQ(hashes(), whole);
    std::filesystem::remove_all(folder_.path / "film");
    ++ends;
  }
  const Result result = test::run(folder_.path, arguments);
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(hashes(), whole) << kills << " kills, " << ends << " ends";
}

TEST_F(TouchingBodies, HaveNoRowsWhereTheyAreApart) {
  const Result result = film("frames = 3\n" + in_place + cube("lower", "") + cube("upper", "position = [0, 1, 0]"));
  EXPECT_EQ(frames_with("pairs"), std::vector<int>());
  EXPECT_EQ(frames_with("deep"), std::vector<int>());
  EXPECT_EQ(result.out.find("other body"), std::string::npos);
}

TEST_F(TouchingBodies, ThatOverlapAtTheStartAreExpectedToBeDeep) {
  film("frames = 3\n" + in_place + cube("lower", "") + cube("upper", "position = [0.02, 0.14, 0.03]"));
  EXPECT_EQ(frames_with("deep"), std::vector<int>());
  EXPECT_EQ(warnings_of_depth(), 0);
  const json first = profile()["frames"][0];
  ASSERT_TRUE(first.contains("pairs"));
  EXPECT_GT(first["pairs"][0]["penetration"], 0.01);
  EXPECT_EQ(first["pairs"][0]["expected"], true);
}

// The upper cube passes through the lower one, by 0.08 m or more when the two begin to meet.
const std::string passing = in_place + "frames = 10\n" + cube("lower", "contact = { meets = false }") +
                            cube("upper", "position = [0.02, 0.25, 0.03]\nvelocity = [0, -1, 0]");
const std::string meet_at_last = "[[change]]\nframe = 4\npath = 'body.lower.contact.meets'\nvalue = true\n";

TEST_F(TouchingBodies, ThatAreDeepInEachOtherAreWarnedOfOnce) {
  film(passing, {}, meet_at_last);
  ASSERT_EQ(frames_with("deep"), std::vector<int>{4});
  const json found = profile()["frames"][4]["deep"];
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0]["bodies"], json::parse(names));
  EXPECT_GT(found[0]["share"], 0.01);
  EXPECT_EQ(found[0]["place"].size(), 3u);
  EXPECT_EQ(warnings_of_depth(), 1) << profile()["summary"]["warnings"];
}

TEST_F(TouchingBodies, ThatAreDeepInEachOtherAreToldOnceWhereAFilmIsResumed) {
  film(passing, {"--frames", "8", "--checkpoint-every", "2"}, meet_at_last);
  film(passing, {"--resume"}, meet_at_last);
  EXPECT_EQ(frames_with("deep"), std::vector<int>{4});
  EXPECT_EQ(warnings_of_depth(), 1) << profile()["summary"]["warnings"];
}

TEST_F(TouchingBodies, ThatAreMeantToOverlapAreNotWarnedOf) {
  for (const char* body : {"lower", "upper"}) {
    film(passing, {fmt::format("--set=body.{}.meant=[\"overlap\"]", body)}, meet_at_last);
    EXPECT_EQ(frames_with("met"), std::vector<int>()) << body;
    EXPECT_EQ(frames_with("deep"), std::vector<int>()) << body;
    EXPECT_EQ(warnings_of_depth(), 0) << body;
  }
}

}  // namespace touching_bodies_test
}  // namespace supple
