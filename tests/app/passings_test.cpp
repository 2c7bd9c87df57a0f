// Bodies that do not meet are warned of where they pass through each other, from the frame on in which they are in the
// same place, and no others are.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "support/bodies.h"
#include "support/places.h"
#include "support/program.h"

namespace supple {
namespace passings_test {

using test::Result;

class Passings : public testing::Test {
 protected:
  Result run(const std::string& verb, const std::string& scene, std::vector<std::string> more = {}) {
    std::ofstream(folder_.path / "scene.toml") << scene;
    more.insert(more.begin(), {verb, "scene.toml"});
    return test::run(folder_.path, more);
  }
  Result film(const std::string& scene, std::vector<std::string> more = {}) {
    more.insert(more.begin(), {"--no-images", "--quiet", "--force"});
    const Result result = run("render", scene, more);
    EXPECT_EQ(result.status, 0) << result.err;
    return result;
  }
  nlohmann::json profile() const { return test::profile_of(folder_.path / "out" / "scene"); }
  nlohmann::json warnings() const { return profile()["summary"]["warnings"]; }

  test::TemporaryFolder folder_;
};

std::string cube(const std::string& name, const std::string& more) {
  return fmt::format(
      "[[body]]\nname = \"{}\"\nbox = {{ extent = [0.2, 0.2, 0.2], cells = [3, 3, 3] }}\nmaterial = \"rubber\"\n{}\n",
      name, more);
}

const std::string meets_none = "contact = { meets = false }\n";
const std::string ground = "[[collider]]\nshape = { half_space = { normal = [0, 1, 0] } }\n";

std::string words(const std::string& a, const std::string& b, int frame) {
  return fmt::format("bodies '{}' and '{}' pass through each other from frame {} on: these two do not meet", a, b,
                     frame);
}

// The upper cube falls 0.2 m until it meets the lower one, which takes 0.2 s.
TEST_F(Passings, OfCubesThatAreDroppedOnEachOtherAreWarnedOf) {
  const std::string scene =
      "frames = 12\n" + cube("lower", meets_none) + cube("upper", "position = [0, 0.4, 0]") + ground;
  const std::string expected = words("lower", "upper", 5);
  EXPECT_EQ(film(scene).err, "warning: " + expected + "\n");
  EXPECT_EQ(warnings(), nlohmann::json::array({expected}));
  EXPECT_EQ(profile()["frames"][5]["met"], nlohmann::json::parse(R"([["lower", "upper"]])"));
  EXPECT_FALSE(profile()["frames"][6].contains("met"));
  for (const char* body : {"lower", "upper"}) {
    EXPECT_EQ(film(scene, {fmt::format("--set=body.{}.meant=[\"overlap\"]", body)}).err, "") << body;
    EXPECT_TRUE(warnings().empty());
  }
  EXPECT_EQ(run("check", scene).out.find("pass through"), std::string::npos) << "they do not at the start";
}

TEST_F(Passings, AreToldOnceWhereAFilmIsResumed) {
  const std::string scene =
      "frames = 12\n" + cube("lower", meets_none) + cube("upper", "position = [0, 0.4, 0]") + ground;
  film(scene, {"--frames", "8", "--checkpoint-every", "4"});
  film(scene, {"--resume"});
  int told = 0;
  const nlohmann::json resumed = profile();
  for (const auto& frame : resumed["frames"]) told += frame.contains("met") ? 1 : 0;
  EXPECT_EQ(told, 1);
  EXPECT_EQ(resumed["summary"]["warnings"].size(), 1u);
}

TEST_F(Passings, AreNotWhatBodiesHaveThatFlyPastEachOtherOrStandSideBySide) {
  EXPECT_EQ(film("frames = 12\ngravity = [0, 0, 0]\n" + cube("a", "position = [-0.5, 0, 0]\nvelocity = [3, 0, 0]") +
                 cube("b", "position = [0.5, 0.2001, 0]\nvelocity = [-3, 0, 0]") + cube("c", "position = [0, 3, 0]") +
                 cube("d", "position = [0.2, 3, 0]"))
                .err,
            "");
  EXPECT_FALSE(profile().dump().find("met\"") != std::string::npos);
}

TEST_F(Passings, OfAClothAndABodyAndOfCrossedBarsAreWarnedOf) {
  const std::string cloth =
      "[[body]]\nname = \"cloth\"\ncloth = { extent = [0.6, 0.6], cells = [6, 6], stretch = 120 }\n"
      "turn_deg = [-90, 0, 0]\nposition = [0, 0.4, 0]\n";
  const Result fallen = film("frames = 12\n" + cube("cube", meets_none) + cloth + ground);
  EXPECT_NE(fallen.err.find("bodies 'cube' and 'cloth' pass through each other from frame "), std::string::npos)
      << fallen.err;
  const std::string bars =
      "frames = 2\ngravity = [0, 0, 0]\n"
      "[[body]]\nname = \"along\"\nbox = { extent = [1, 0.1, 0.1], cells = [1, 1, 1] }\nmeant = [\"thin\"]\n"
      "material = \"rubber\"\ncontact = { meets = false }\n"
      "[[body]]\nname = \"across\"\nbox = { extent = [0.1, 0.1, 1], cells = [1, 1, 1] }\nmeant = [\"thin\"]\n"
      "material = \"rubber\"\n";
  EXPECT_EQ(film(bars).err, "warning: " + words("along", "across", 0) + "\n");
}

TEST_F(Passings, AtTheStartAreToldByCheck) {
  const std::string scene = cube("a", meets_none) + cube("b", "position = [0.1, 0.1, 0]") + ground;
  const std::string expected = "bodies 'a' and 'b' pass through each other from the start on: these two do not meet";
  EXPECT_NE(run("check", scene).out.find(expected), std::string::npos);
  const auto list = nlohmann::json::parse(run("check", scene, {"--json", "--set=body.a.meant=[\"overlap\"]"}).out);
  ASSERT_EQ(list["warnings"].size(), 1u) << list.dump();
  EXPECT_EQ(list["warnings"][0]["kind"], "overlap");
  EXPECT_EQ(list["warnings"][0]["meant"], true);
  const std::string meeting = run("check", scene, {"--set=body.a.contact.meets=true"}).out;
  EXPECT_EQ(meeting.find("pass through"), std::string::npos) << meeting;
  EXPECT_NE(meeting.find("bodies 'a' and 'b' overlap at the start, by up to "), std::string::npos) << meeting;
  const std::string turned = "contact = { meets = false }\nturn_deg = [0, 0, 45]\n";
  EXPECT_EQ(
      run("check", cube("a", turned) + cube("b", turned + "position = [0.145, 0.145, 0]")).out.find("pass through"),
      std::string::npos)
      << "the boxes around them overlap, and they do not";
}

TEST_F(Passings, OfABodyAloneAreNot) {
  EXPECT_EQ(film("frames = 3\n" + cube("alone", "") + ground).err, "");
  EXPECT_FALSE(profile()["frames"][0].contains("met"));
}

}  // namespace passings_test
}  // namespace supple
