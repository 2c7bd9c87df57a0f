// Tests the program as a user runs it: exit statuses, messages, and the folder that a run leaves.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "output/files/png_file.h"
#include "output/video/video.h"
#include "support/bodies.h"
#include "support/places.h"
#include "support/program.h"

namespace supple {
namespace program_test {

using test::profile_of;
using test::Result;
using test::run;

// Describes a head of 400 vertices, filmed at a small size.
void write_scene(const std::filesystem::path& path, const std::string& more = "") {
  std::ofstream(path) << "frames = 6\n"
                      << more << R"(
[[body]]
name = "head"
shape = "shapes/squirrel.toml"
vertices = 1500
size = 0.4
skin_cells = 24
material = { model = "polynomial", mu = 2e7 }
[[body.handles]]
name = "neck"
select = { box = [[0, 0, 0], [1, 0.2, 1]] }
keys = [{ t = 0 }, { t = 0.1, move = [0.03, 0, 0] }]
[output]
width = 160
height = 90
samples = 1
)";
}

std::vector<std::string> hashes_of(const std::filesystem::path& run_folder) {
  std::vector<std::string> hashes;
  const nlohmann::json profile = profile_of(run_folder);
  for (const auto& frame : profile["frames"]) hashes.push_back(frame["state_hash"]);
  return hashes;
}

TEST(Program, LeavesAFolderThatExplainsItself) {
  const test::TemporaryFolder folder;
  write_scene(folder.path / "head.toml");
  const Result result = run(folder.path, {"render", "head.toml", "--error-every", "2"});
  ASSERT_EQ(result.status, 0) << result.err;
  const std::filesystem::path out = folder.path / "out" / "head";
  for (int frame = 0; frame < 6; ++frame)
    EXPECT_EQ(read_png(out / "frames" / fmt::format("{:06}.png", frame)).width, 160);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(out / "frames"), {}), 6);
  if (std::filesystem::exists(out / "video.mp4")) {
    EXPECT_EQ(count_video_frames(out / "video.mp4"), 6);
  }
  const auto info = nlohmann::json::parse(test::read_file(out / "run.json"));
  EXPECT_EQ(info["ended"], "done");
  EXPECT_EQ(info["frames"], 6);
  EXPECT_EQ(info["scene"]["body"][0]["vertices"], 1500);
  EXPECT_EQ(info["command"][2], "head.toml");
  EXPECT_FALSE(info["gl"]["renderer"].get<std::string>().empty());
  const auto profile = profile_of(out);
  ASSERT_EQ(profile["frames"].size(), 6u);
  const auto& body = profile["frames"][2]["bodies"][0];
  EXPECT_TRUE(body["error"].is_number());
  EXPECT_FALSE(profile["frames"][1]["bodies"][0].contains("error"));
  const double phases = body["evaluate_ms"].get<double>() + body["solve_ms"].get<double>() +
                        body["lbfgs_ms"].get<double>() + body["matrix_ms"].get<double>() +
                        body["other_ms"].get<double>();
  EXPECT_NEAR(phases, body["step_ms"].get<double>(), 0.01);
  EXPECT_EQ(std::filesystem::file_size(out / "motion" / "head.pc2") % 12, 32 % 12);
}

TEST(Program, GivesTheSameHashesForAnyThreadsWithAndWithoutImages) {
  const test::TemporaryFolder folder;
  write_scene(folder.path / "head.toml");
  const auto hashes = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"render", "head.toml", "--no-video", "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    EXPECT_EQ(run(folder.path, arguments).status, 0);
    return hashes_of(folder.path / "out" / "head");
  };
  const std::vector<std::string> expected = hashes({"--threads", "1", "--no-images"});
  EXPECT_EQ(expected.size(), 6u);
  EXPECT_NE(expected[0], expected[1]);
  for (const char* threads : {"1", "2", "4"}) EXPECT_EQ(hashes({"--threads", threads}), expected);
}

TEST(Program, RefusesBadInputWithStatusTwoAndOneClearMessage) {
  const test::TemporaryFolder folder;
  write_scene(folder.path / "typo.toml", "frmes = 3\n");
  EXPECT_EQ(run(folder.path, {"render", "typo.toml"}).status, 2);
  EXPECT_EQ(run(folder.path, {"check", "typo.toml"}).err,
            "typo.toml:2:1: unknown key 'frmes'; did you mean 'frames'?\n");
  EXPECT_FALSE(std::filesystem::exists(folder.path / "out"));
  EXPECT_EQ(run(folder.path, {"render", "none.toml"}).err, "none.toml: no such file\n");
  EXPECT_EQ(run(folder.path, {"render"}).status, 2);
  EXPECT_EQ(run(folder.path, {"frobnicate"}).status, 2);
  EXPECT_EQ(run(folder.path, {"render", "typo.toml", "--threads", "0"}).status, 2);
  EXPECT_EQ(run(folder.path, {"info", "typo.toml"}).status, 2);
  write_scene(folder.path / "head.toml");
  const Result endless = run(folder.path, {"render", "head.toml", "--verify", "/dev/zero"});
  EXPECT_EQ(endless.status, 2);
  EXPECT_NE(endless.err.find("/dev/zero: is not a file\n"), std::string::npos) << endless.err;
  EXPECT_EQ(run(folder.path, {"--help"}).status, 0);
  EXPECT_EQ(run(folder.path, {"list"}).status, 0);
}

TEST(Program, KeepsTheFramesBeforeABodyThatFliesApart) {
  const test::TemporaryFolder folder;
  write_scene(folder.path / "wild.toml");
  const Result result = run(folder.path, {"render", "wild.toml", "--no-video", "--frames", "200", "--set",
                                          "body.head.solver.line_search=none", "--set", "body.head.solver.levels=1",
                                          "--set", "body.head.material.mu=1e9", "--set", "gravity=[0,-2000,0]"});
  ASSERT_EQ(result.status, 1) << result.err;
  EXPECT_NE(result.err.find("supple: frame "), std::string::npos);
  for (const char* word : {"body 'head'", "vertex ", "kept: "})
    EXPECT_NE(result.err.find(word), std::string::npos) << result.err;
  const std::filesystem::path out = folder.path / "out" / "wild";
  const auto info = nlohmann::json::parse(test::read_file(out / "run.json"));
  EXPECT_TRUE(info["ended"].get<std::string>().starts_with("failed"));
  const int frames = info["frames"];
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(out / "frames"), {}), frames);
  EXPECT_EQ(profile_of(out)["frames"].size(), std::size_t(frames));
}

TEST(Program, EndsAfterTheFrameInProgressWhenInterrupted) {
  const test::TemporaryFolder folder;
  write_scene(folder.path / "long.toml");
  const std::filesystem::path out = folder.path / "out" / "long";
  const Result result =
      run(folder.path, {"render", "long.toml", "--frames", "100000", "--no-video"}, out / "frames" / "000003.png");
  EXPECT_EQ(result.status, 130) << result.err;
  const auto profile = profile_of(out);
  const std::size_t frames = profile["frames"].size();
  EXPECT_GE(frames, 4u);
  EXPECT_EQ(std::size_t(std::distance(std::filesystem::directory_iterator(out / "frames"), {})), frames);
  EXPECT_NO_THROW(read_png(out / "frames" / fmt::format("{:06}.png", frames - 1)));
}

TEST(Program, FinishesARunWhoseListenerHasGone) {
  const test::TemporaryFolder folder;
  write_scene(folder.path / "head.toml");
  const std::string command =
      fmt::format("cd '{}' && '{}' render head.toml --no-images 2>&1 | true", folder.path.string(), test::program_name);
  (void)!std::system(command.c_str());
  const auto info = nlohmann::json::parse(test::read_file(folder.path / "out" / "head" / "run.json"));
  EXPECT_EQ(info["ended"], "done");
  EXPECT_EQ(hashes_of(folder.path / "out" / "head").size(), 6u);
}

TEST(Program, TakesThePapersSquirrelInThePlaceOfOurs) {
  const auto mesh = test::paper_mesh("squirrel_modified");
  if (!mesh) GTEST_SKIP() << "no SUPPLE_PAPER_MESHES: squirrel_modified";
  const test::TemporaryFolder folder;
  const Result result = run(folder.path, {"render", "squirrel", "--no-images", "--frames", "3", "--set",
                                          "body.polynomial.mesh=" + mesh->string()});
  ASSERT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.err.find("polynomial: 8395 vertices, 23645 elements"), std::string::npos) << result.err;
}

}  // namespace program_test
}  // namespace supple
