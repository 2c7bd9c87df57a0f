// Tests what `supple check` says of pictures that will miss a body, and what the first pass of a film has them show.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "app/solvers.h"
#include "film/plan/shipped_files.h"
#include "film/rough_pictures.h"
#include "output/motion/point_cache.h"
#include "support/bodies.h"
#include "support/program.h"

namespace supple {
namespace check_pictures_test {

using test::run;

constexpr const char* boxes = R"(frames = 40
gravity = [0, 0, 0]
[[body]]
name = "still"
box = { extent = [0.2, 0.2, 0.2], cells = [4, 4, 4] }
position = [0, 0.2, 0]
material = "rubber"
[[body]]
name = "rising"
box = { extent = [0.2, 0.2, 0.2], cells = [4, 4, 4] }
position = [0.5, 0.2, 0]
velocity = [0, 2, 0]
material = "rubber"
)";

std::string checked(const std::filesystem::path& folder, const std::string& camera,
                    const std::vector<std::string>& more = {}) {
  std::ofstream(folder / "s.toml") << boxes << camera;
  std::vector<std::string> words = {"check", "s.toml"};
  words.insert(words.end(), more.begin(), more.end());
  const test::Result result = run(folder, words);
  EXPECT_EQ(result.status, 0) << result.err;
  return result.out;
}

TEST(CheckPictures, NameTheBodyThatLeavesThemAndTheFirstFrame) {
  const test::TemporaryFolder folder;
  const std::string still = "[camera]\nframes = \"start\"\n";
  const std::string out = checked(folder.path, still);
  EXPECT_NE(out.find("warning: s.toml: in the rough first pass of the film, body 'rising' is out of the picture in "),
            std::string::npos)
      << out;
  EXPECT_NE(out.find(" of 40 frames, first in frame "), std::string::npos) << out;
  EXPECT_EQ(out.find("body 'still' is out"), std::string::npos) << out;

  // The check uses the words with which render warns of the film.
  const std::size_t begin = out.find("body 'rising'");
  const std::string words = out.substr(begin, out.find('\n', begin) - begin);
  const test::Result rendered = run(folder.path, {"render", "s.toml", "--quiet", "--no-video", "--set",
                                                  "output.width=96", "--set", "output.height=54"});
  EXPECT_NE(rendered.err.find(words), std::string::npos) << words << '\n' << rendered.err;

  EXPECT_EQ(checked(folder.path, "[camera]\nframes = \"film\"\n").find("rough"), std::string::npos);
  EXPECT_EQ(checked(folder.path, still, {"--set", "body.rising.velocity=[0, 0, 0]"}).find("rough"), std::string::npos);
}

TEST(CheckPictures, ShowTheWholeMotionWhereItIsAskedForAndNothingPlacesTheCamera) {
  const test::TemporaryFolder folder;
  const std::string automatic = "[camera]\nframes = \"auto\"\n";
  EXPECT_EQ(checked(folder.path, automatic).find("rough"), std::string::npos);
  const std::vector<std::string> words = {"render", "s.toml", "--no-video", "--size", "96x54", "--out", "a"};
  const test::Result film = run(folder.path, words);
  EXPECT_NE(film.err.find("the camera shows the bodies' whole motion, which leaves the picture of the start: a rough "
                          "first pass of all 40 frames found it in "),
            std::string::npos)
      << film.err;
  EXPECT_EQ(film.err.find("out of the picture"), std::string::npos) << film.err;
  for (const auto& row : test::profile_of(folder.path / "a")["frames"])
    for (const auto& body : row["bodies"]) EXPECT_EQ(body["in_picture"].get<double>(), 1);

  // A film whose bodies stay in the picture of the start keeps that picture. So does one whose scene places the camera.
  const auto bytes = [&](const std::string& name, const std::string& camera, const std::string& velocity) {
    std::ofstream(folder.path / "s.toml") << boxes << camera;
    const test::Result made = run(folder.path, {"render", "s.toml", "--no-video", "--size", "96x54", "--out", name,
                                                "--frames", "12", "--set", "body.rising.velocity=" + velocity});
    EXPECT_EQ(made.err.find("the camera shows"), std::string::npos) << made.err;
    return test::read_file(folder.path / name / "frames" / "000011.png");
  };
  EXPECT_EQ(bytes("b", automatic, "[0, 0, 0]"), bytes("c", "[camera]\nframes = \"start\"\n", "[0, 0, 0]"));
  const std::string placed = "[camera]\nposition = [0, 1, 3]\ntarget = [0, 0.4, 0]\n";
  EXPECT_EQ(bytes("d", placed + "frames = \"auto\"\n", "[0, 4, 0]"),
            bytes("e", placed + "frames = \"start\"\n", "[0, 4, 0]"));
}

TEST(CheckPictures, SayThatNoneShowsABody) {
  const test::TemporaryFolder folder;
  const std::string out = checked(folder.path, "[camera]\nposition = [0, 1, 3]\ntarget = [0, 1, 9]\n");
  EXPECT_NE(out.find("in the rough first pass of the film, no picture shows a body; camera.frames"), std::string::npos)
      << out;
}

TEST(CheckPictures, AreThoseOfTheStartWhereAFrameWouldTakeTooLong) {
  const test::TemporaryFolder folder;
  const std::vector<std::string> slow = {"--set", "substeps=1000", "--set", "body.still.box.cells=[20, 20, 20]"};
  const std::string camera = "[camera]\nposition = [0, 1, 3]\ntarget = [0, 1, 9]\n";
  const std::string out = checked(folder.path, camera, slow);
  EXPECT_NE(out.find("at the start, no picture shows a body; camera.frames"), std::string::npos) << out;
  EXPECT_EQ(checked(folder.path, "", slow).find("picture"), std::string::npos);
}

TEST(CheckPictures, SayThatAnotherAspectRatioCutsBodies) {
  const test::TemporaryFolder folder;
  const std::vector<std::string> wide = {"check", "integrators",      "--set", "output.width=640",
                                         "--set", "output.height=360"};
  const std::string out = run(folder.path, wide).out;
  EXPECT_NE(out.find(", the picture's border cuts body 'euler' in "), std::string::npos) << out;
}

// A replay is followed to its first change, which may move the camera away.
TEST(CheckPictures, FollowAReplayToItsFirstChange) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path / "s.toml") << boxes;
  std::ofstream(folder.path / "r.toml")
      << "scene = \"s.toml\"\n[[change]]\nt = 0.1\npath = \"gravity\"\nvalue = [0, -9, 0]\n";
  const test::Result result = run(folder.path, {"check", "r.toml"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(result.out.find("rough"), std::string::npos) << result.out;
}

TEST(CheckPictures, OfAllScenesThatShipShowTheirBodies) {
  for (const std::string& name : shipped_names("scenes")) {
    FilmPlan plan;
    plan.scene = name;
    for (const std::string& warning : missing_in_rough_pictures(plan, all_solvers()))
      ADD_FAILURE() << name << ": " << warning;
  }
}

// Coarse cubes would roll to other places.
TEST(CheckPictures, FrameTheFilmsOwnMotionWhereTheFirstPassCanAffordItsMeshes) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path / "thrown.toml") << R"(frames = 40
[[body]]
name = "cube"
box = { extent = [0.2, 0.2, 0.2], cells = [5, 5, 5] }
position = [0, 0.3, 0]
velocity = [1.5, 0, 0]
spin_deg = [30, 0, -300]
material = "jelly"
[[collider]]
shape = { half_space = { normal = [0, 1, 0] } }
friction = 0.6
[camera]
frames = "film"
)";
  ASSERT_EQ(run(folder.path, {"render", "thrown.toml", "--quiet", "--no-video", "--size", "64x36"}).status, 0);
  const auto framed = nlohmann::json::parse(test::read_file(folder.path / "out" / "thrown" / "run.json"))["framed"];
  double farthest = -1e9;
  for (const auto& point : framed) farthest = std::max(farthest, point[0].get<double>());
  PointCacheReader motion(folder.path / "out" / "thrown" / "motion" / "cube.pc2");
  double reached = -1e9;
  for (int frame = 0; frame < motion.frames(); ++frame)
    reached = std::max(reached, motion.frame(frame).col(0).maxCoeff());
  EXPECT_NEAR(farthest, reached, 0.03 * reached) << "2 % of air beside what the film itself reaches";
}

}  // namespace check_pictures_test
}  // namespace supple
