// Tests films that were killed, interrupted or failed, and are resumed: they must be those of a run that was left
// alone.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <random>

#include "support/bodies.h"
#include "support/program.h"
#include "support/replayed_film.h"
#include "support/surfaces.h"

namespace supple {
namespace resume_test {

using test::read_file;
using test::Result;
using test::run;

class ResumedFilm : public test::ReplayedFilm {};

TEST_F(ResumedFilm, GoesOnAfterBeingKilledAsIfNothingHadHappened) {
  ASSERT_EQ(run(folder_.path, film({"--out", "whole"})).status, 0);
  std::mt19937 dice(5);
  int kills = 0;
  for (int attempt = 0; attempt < 6; ++attempt) {
    std::filesystem::remove_all(folder_.path / "cut");
    std::vector<std::string> arguments = film({"--out", "cut", "--checkpoint-every", "1"});
    // Four times the run is killed after a picture in the middle of the film exists, so that it is certain to be
    // running; otherwise it is killed at any time.
    const std::filesystem::path picture = folder_.path / "cut" / "frames" / fmt::format("{:06}.png", dice() % 16);
    Result result = attempt < 4 ? run(folder_.path, arguments, picture, SIGKILL)
                                : test::run_and_kill(folder_.path, arguments, int(dice() % 900));
    kills += result.status < 0;
    arguments.push_back("--resume");
    if (attempt % 2 == 0 && std::filesystem::exists(folder_.path / "cut" / "run.json"))  // and once more
      kills += test::run_and_kill(folder_.path, arguments, int(dice() % 900)).status < 0;
    result = run(folder_.path, arguments);
    ASSERT_EQ(result.status, 0) << result.err;
    expect_the_same_film("whole", "cut");
  }
  EXPECT_GE(kills, 4);
}

TEST_F(ResumedFilm, GoesOnAfterAnInterruptAndMayBecomeLonger) {
  ASSERT_EQ(run(folder_.path, film({"--out", "whole", "--frames", "30"})).status, 0);
  const Result cut = run(folder_.path, film({"--out", "cut"}), folder_.path / "cut" / "frames" / "000004.png");
  ASSERT_EQ(cut.status, 130) << cut.err;
  const Result on = run(folder_.path, film({"--out", "cut", "--resume"}));
  ASSERT_EQ(on.status, 0) << on.err;
  EXPECT_NE(on.err.find("note: resuming after frame "), std::string::npos) << on.err;
  EXPECT_EQ(hashes("cut").size(), 24u);
  ASSERT_EQ(run(folder_.path, film({"--out", "cut", "--resume", "--frames", "30"})).status, 0);
  expect_the_same_film("whole", "cut");
  EXPECT_EQ(run(folder_.path, film({"--out", "cut", "--resume", "--frames", "20"})).status, 2);
}

TEST_F(ResumedFilm, SaysWhereGraphsOfALongerFilmHaveAnotherLength) {
  const auto longer = [&](const char* frames, bool resumed) {
    std::vector<std::string> arguments = film({"--out", "a", "--frames", frames, "--set", "text.error_graph=true"});
    if (resumed) arguments.push_back("--resume");
    const Result result = run(folder_.path, arguments);
    EXPECT_EQ(result.status, 0) << result.err;
    return result.err;
  };
  EXPECT_EQ(longer("6", false).find("graphs"), std::string::npos);
  EXPECT_EQ(longer("6", true).find("graphs"), std::string::npos);
  EXPECT_NE(longer("9", true).find("the graphs in the first 6 pictures are 6 frames long"), std::string::npos);
}

TEST_F(ResumedFilm, RefusesTheCheckpointOfAnotherFilm) {
  ASSERT_EQ(run(folder_.path, film({"--out", "a", "--no-images"})).status, 0);
  const auto refused = [&](std::vector<std::string> more) {
    more.insert(more.end(), {"--out", "a", "--resume"});
    const Result result = run(folder_.path, film(more));
    EXPECT_EQ(result.status, 2) << result.err;
    return result.err;
  };
  EXPECT_NE(refused({"--no-images", "--set", "body.bar.density=900"}).find("scene.body.bar.density: nothing and 900"),
            std::string::npos);
  EXPECT_NE(refused({}).find("images: false and true"), std::string::npos);
  EXPECT_NE(refused({"--no-images", "--vtu", "4"}).find("vtu: 0 and 4"), std::string::npos);
  EXPECT_NE(refused({"--no-images", "--frames", "30", "--save-state", "23"}).find("goes on with frame 24"),
            std::string::npos);
  EXPECT_EQ(hashes("a").size(), 24u);  // nothing of it was lost
  std::string bytes = read_file(folder_.path / "a" / "checkpoint" / "state");
  bytes[bytes.size() / 2] ^= 1;
  std::ofstream(folder_.path / "a" / "checkpoint" / "state", std::ios::binary) << bytes;
  EXPECT_NE(refused({"--no-images"}).find("is damaged"), std::string::npos);
  bytes[std::string_view("supple checkpoint ").size()] = '3';  // as an earlier version wrote it
  std::ofstream(folder_.path / "a" / "checkpoint" / "state", std::ios::binary) << bytes;
  EXPECT_NE(refused({"--no-images"}).find("not a checkpoint of this version"), std::string::npos);
}

// Returns two tetrahedra with a region each.
std::string two_regions(int first, int second) {
  return fmt::format(
      "MeshVersionFormatted 2\nDimension 3\nVertices\n5\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n1 1 1 0\n"
      "Tetrahedra\n2\n1 2 3 4 {}\n2 5 3 4 {}\nEnd\n",
      first, second);
}

TEST_F(ResumedFilm, RefusesTheCheckpointOfOtherFiles) {
  const auto write = [&](const char* name, const std::string& text) { std::ofstream(folder_.path / name) << text; };
  const std::string ball = "[[part]]\nsphere = { radius = 0.1 }\n";
  write("ball.toml", ball);
  write("later.toml", ball);
  write("last.toml", ball);
  write("two.mesh", two_regions(1, 2));
  write("files.toml", R"(frames = 6
[[body]]
name = "solid"
mesh = "two.mesh"
material = "rubber"
position = [0, 2, 0]
[body.regions.1]
material = "jelly"
[[collider]]
name = "ball"
shape = "ball.toml"
)");
  const std::string change = "[[change]]\npath = \"collider.ball.shape\"\n";
  write("r.toml", "scene = \"files.toml\"\n" + change + "frame = 3\nvalue = \"later.toml\"\n" + change +
                      "frame = 8\nvalue = \"last.toml\"\n");
  const auto resumed = [&] { return run(folder_.path, film({"--no-images", "--out", "a", "--resume"})); };
  ASSERT_EQ(run(folder_.path, film({"--no-images", "--out", "a"})).status, 0);
  write("ball.toml", "# the same ball\n" + ball);
  EXPECT_EQ(resumed().status, 0);
  const auto expect_refused = [&](const char* name, const std::string& text) {
    const std::string before = read_file(folder_.path / name);
    write(name, text);
    const Result result = resumed();
    EXPECT_EQ(result.status, 2) << name;
    EXPECT_NE(result.err.find(fmt::format("files.{}.xxh64: ", name)), std::string::npos) << result.err;
    write(name, before);
    EXPECT_EQ(resumed().status, 0) << name;
  };
  expect_refused("ball.toml", "[[part]]\nsphere = { radius = 0.11 }\n");
  expect_refused("later.toml", "[[part]]\nsphere = { radius = 0.11 }\n");
  expect_refused("two.mesh", two_regions(2, 1));
  expect_refused("last.toml", "[[part]]\nsphere = { radius = 0.11 }\n");
  EXPECT_EQ(run(folder_.path, film({"--no-images", "--out", "a", "--resume", "--frames", "12"})).status, 0);
}

// The springs of a handle that lets go later hold energy where the film is resumed.
TEST_F(ResumedFilm, FindsNoEnergyFromNothingWhereTheRunHadNone) {
  std::ofstream(folder_.path / "hung.toml") << R"(frames = 12
[[body]]
name = "cube"
box = { extent = [0.1, 0.1, 0.1], cells = [1, 1, 1] }
material = "jelly"
velocity = [0, 1, 0]
[[body.handles]]
name = "hand"
select = { box = [[0, 0, 0], [1, 0.1, 1]] }
stiffness = 30
keys = [{ t = 0 }, { t = 0.1, move = [0.4, 0, 0] }]
until = 0.2
)";
  const auto film = [&](const char* out, const char* frames) {
    return run(folder_.path, {"render", "hung.toml", "--no-images", "--out", out, "--frames", frames, "--resume"});
  };
  ASSERT_EQ(film("whole", "12").status, 0);
  ASSERT_EQ(film("cut", "4").status, 0);
  ASSERT_EQ(film("cut", "12").status, 0);
  const auto whole = test::profile_of(folder_.path / "whole")["frames"];
  const auto cut = test::profile_of(folder_.path / "cut")["frames"];
  for (std::size_t frame = 0; frame < 12; ++frame)
    for (const char* key : {"from_nothing", "total", "put_in", "exchanged"})
      EXPECT_NEAR(cut[frame]["bodies"][0]["energy"][key].get<double>(),
                  whole[frame]["bodies"][0]["energy"][key].get<double>(), 1e-9)
          << key << " in frame " << frame;
}

TEST_F(ResumedFilm, NamesTheColoursOfAModelThatHaveChanged) {
  const auto write = [&](const char* name, const std::string& text) { std::ofstream(folder_.path / name) << text; };
  write("red.obj", "mtllib red.mtl\nusemtl red\n" + test::obj_text(test::box_surface(Vec3(0.2, 0.2, 0.2))));
  write("red.mtl", "newmtl red\nKd 1 0 0\n");
  write("red.toml", "frames = 2\n[[body]]\nsurface = \"red.obj\"\nvertices = 60\nmaterial = \"jelly\"\n");
  ASSERT_EQ(run(folder_.path, {"render", "red.toml", "--no-images", "--out", "red"}).status, 0);
  write("red.mtl", "newmtl red\nKd 0 1 0\n");
  const Result result = run(folder_.path, {"render", "red.toml", "--no-images", "--out", "red", "--resume"});
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.err.find("files.colours of red.obj.xxh64: "), std::string::npos) << result.err;
}

TEST_F(ResumedFilm, StartsAnewWhereThereIsNoCheckpointYet) {
  const Result result = run(folder_.path, film({"--out", "a", "--no-images", "--resume"}));
  EXPECT_EQ(result.status, 0);
  EXPECT_NE(result.err.find("has no checkpoint yet"), std::string::npos) << result.err;
}

TEST_F(ResumedFilm, LeavesAFilmWithoutACheckpointAloneUnlessItsRunWasCutShort) {
  const auto filmed = [this](const std::vector<std::string>& more) {
    std::vector<std::string> words = {"render", "two.toml", "--no-images", "--quiet", "--checkpoint-every", "0"};
    words.insert(words.end(), more.begin(), more.end());
    return run(folder_.path, words);
  };
  ASSERT_EQ(filmed({"--out", "a"}).status, 0);
  const Result complete = filmed({"--out", "a", "--resume"});
  EXPECT_EQ(complete.status, 2);
  EXPECT_NE(complete.err.find("a holds a film that is complete, of 24 frames"), std::string::npos) << complete.err;
  EXPECT_NE(complete.err.find("without --resume it is made anew"), std::string::npos) << complete.err;
  EXPECT_EQ(hashes("a").size(), 24u);

  const std::filesystem::path file = folder_.path / "a" / "run.json";
  std::string text = read_file(file);
  text.replace(text.find("\"done\""), 6, "\"running\"");  // as a run that was killed leaves it
  std::ofstream(file) << text;
  const Result other = filmed({"--out", "a", "--resume", "--set", "body.bar.density=900"});
  EXPECT_EQ(other.status, 2);
  EXPECT_NE(other.err.find("scene.body.bar.density: nothing and 900"), std::string::npos) << other.err;
  EXPECT_EQ(hashes("a").size(), 24u);
  const Result same = filmed({"--out", "a", "--resume", "--frames", "4"});
  EXPECT_EQ(same.status, 0) << same.err;
  EXPECT_EQ(hashes("a").size(), 4u);
}

TEST_F(ResumedFilm, GoesOnBehindTheLastWholeFrameOfARunThatFailed) {
  ASSERT_EQ(run(folder_.path, film({"--no-images", "--record", "film.rec"})).status, 0);
  std::string text = read_file(folder_.path / "r.toml");
  text.replace(text.find("value = 2e5"), 11, "value = 3e5");
  std::ofstream(folder_.path / "r.toml") << text;
  ASSERT_EQ(run(folder_.path, film({"--no-images", "--out", "whole"})).status, 0);
  ASSERT_EQ(run(folder_.path, film({"--no-images", "--out", "cut", "--verify", "film.rec"})).status, 1);
  const std::size_t kept = hashes("cut").size();
  EXPECT_GE(kept, 6u);  // the change is at 0.2 s
  const Result on = run(folder_.path, film({"--no-images", "--out", "cut", "--resume"}));
  EXPECT_EQ(on.status, 0) << on.err;
  EXPECT_NE(on.err.find(fmt::format("note: resuming after frame {} of 24", kept)), std::string::npos) << on.err;
  expect_the_same_film("whole", "cut");
}

TEST_F(ResumedFilm, RefusesToGoOnBehindFilesThatWereCutAndTouchesNothing) {
  ASSERT_EQ(run(folder_.path, film({"--no-images", "--out", "a"})).status, 0);
  for (const char* name : {"motion/colliders.csv", "motion/sheet.pc2", "checkpoint/rows.jsonl"}) {
    const std::filesystem::path file = folder_.path / "a" / name;
    const std::string whole = read_file(file);
    std::filesystem::resize_file(file, 100);
    const Result result = run(folder_.path, film({"--no-images", "--out", "a", "--resume", "--frames", "26"}));
    EXPECT_EQ(result.status, 2) << name;
    EXPECT_NE(result.err.find(std::string("a/") + name + ": "), std::string::npos) << result.err;
    EXPECT_EQ(std::filesystem::file_size(file), 100u);
    EXPECT_EQ(hashes("a").size(), 24u);
    std::ofstream(file, std::ios::binary) << whole;
  }
  EXPECT_EQ(run(folder_.path, film({"--no-images", "--out", "a", "--resume", "--frames", "26"})).status, 0);
}

TEST_F(ResumedFilm, GoesOnBehindStatesThatWereSavedUnlessTheyAreGone) {
  ASSERT_EQ(run(folder_.path, film({"--no-images", "--out", "a", "--frames", "6", "--save-state", "2"})).status, 0);
  EXPECT_EQ(
      run(folder_.path, film({"--no-images", "--out", "a", "--frames", "9", "--resume", "--save-state", "2,7"})).status,
      0);
  std::filesystem::remove_all(folder_.path / "a" / "states" / "bar-000002");
  EXPECT_EQ(run(folder_.path, film({"--no-images", "--out", "a", "--resume", "--save-state", "2"})).status, 2);
}

TEST_F(ResumedFilm, StartsAnewInAFolderThatARunHadOnlyBegunToTake) {
  ASSERT_EQ(run(folder_.path, film({"--no-images", "--out", "a", "--frames", "6"})).status, 0);
  std::ofstream(folder_.path / "a" / "run.json") << "{}\n";  // another run's first act
  const Result result =
      run(folder_.path, {"render", "two.toml", "--no-images", "--frames", "3", "--out", "a", "--resume"});
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_EQ(hashes("a").size(), 3u);
}

}  // namespace resume_test
}  // namespace supple
