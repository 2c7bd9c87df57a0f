// Tests the profiler as a user runs it.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "output/run/zones.h"
#include "support/bodies.h"
#include "support/places.h"
#include "support/program.h"

namespace supple {
namespace profile_test {

using test::Result;
using test::run;

void write_scene(const std::filesystem::path& path) {
  std::ofstream(path) << R"(frames = 5
[[body]]
name = "bar"
box = { extent = [0.4, 0.1, 0.1], cells = [8, 2, 2] }
position = [0, 0.3, 0]
material = { model = "neo-hookean", mu = 1e4, lambda = 4e4 }
[[body.handles]]
name = "end"
select = { box = [[0, 0, 0], [0, 1, 1]] }
[[collider]]
name = "floor"
shape = { half_space = { normal = [0, 1, 0] } }
[output]
width = 160
height = 90
samples = 1
)";
}

TEST(Profile, OfASceneLeavesZonesTraceAndPlot) {
  const test::TemporaryFolder folder;
  write_scene(folder.path / "bar.toml");
  const Result result = run(folder.path, {"profile", "bar.toml", "--repeats", "2", "--threads", "2"});
  ASSERT_EQ(result.status, 0) << result.err;
  for (const char* word : {"\n  frame ", "meanwhile, render", "Deadline 33.3 ms: of 8 frames", "build models"})
    EXPECT_NE(result.out.find(word), std::string::npos) << word << "\n" << result.out;
  const std::filesystem::path out = folder.path / "out" / "bar-profile";
  const ZoneProfile profile = read_zones(out / "zones.json");
  EXPECT_EQ(profile.repeats, 2);
  EXPECT_EQ(profile.run.frames, 5);
  EXPECT_FALSE(profile.run.pictures.empty());
  // The table may list them among the smaller zones, when the pictures are waited for.
  for (const char* name : {"step", "evaluate"})
    EXPECT_TRUE(std::ranges::any_of(profile.zones, [name](const ZoneTimes& zone) { return zone.name() == name; }))
        << name;
  const ZoneTimes& whole = profile.zones.front();
  for (int repeat = 0; repeat < 2; ++repeat) {
    for (int frame = 0; frame < 5; ++frame) {
      double sum = 0;
      for (const ZoneTimes& zone : profile.zones) {
        if (zone.thread == whole.thread) sum += zone.self_ms[repeat][frame];
        EXPECT_GE(zone.self_ms[repeat][frame], -1e-3) << zone.path;
      }
      EXPECT_NEAR(sum, whole.ms[repeat][frame], 0.01);
    }
  }
  const auto trace = nlohmann::json::parse(test::read_file(out / "trace.json"));
  std::vector<std::string> tracks;
  for (const auto& event : trace["traceEvents"]) {
    if (event["name"] == "thread_name") tracks.push_back(event["args"]["name"]);
  }
  for (const char* track : {"main", "render", "compress 1", "output"})
    EXPECT_NE(std::ranges::find(tracks, track), tracks.end()) << track;
  EXPECT_TRUE(std::filesystem::exists(out / "frame-times.csv"));
  EXPECT_EQ(std::filesystem::exists(out / "frame-times.svg"), result.err.find("gnuplot") == std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(out / "video.mp4"));
}

TEST(Profile, RemovesNoFilm) {
  const test::TemporaryFolder folder;
  write_scene(folder.path / "bar.toml");
  const auto profile = [&](const std::string& repeats, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"profile", "bar.toml", "--no-images", "--quiet", "--repeats", repeats};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(folder.path, arguments);
  };
  ASSERT_EQ(run(folder.path, {"render", "bar.toml", "--quiet"}).status, 0);
  const std::filesystem::path film = folder.path / "out" / "bar";
  const std::string before = test::read_file(film / "run.json");
  for (const char* repeats : {"1", "2"}) {
    EXPECT_EQ(profile(repeats, {}).status, 0) << "into a folder of its own, and once more there";
    const Result refused = profile(repeats, {"--out", "out/bar"});
    EXPECT_EQ(refused.status, 2);
    EXPECT_EQ(refused.err, "--out out/bar: holds a film, which a profile would remove; name another folder\n");
  }
  EXPECT_EQ(read_zones(folder.path / "out" / "bar-profile" / "zones.json").repeats, 2);
  EXPECT_EQ(test::read_file(film / "run.json"), before);
  EXPECT_TRUE(std::filesystem::exists(film / "frames" / "000004.png"));
  std::filesystem::rename(film, folder.path / "own-against");
  EXPECT_EQ(profile("4", {"--out", "own", "--against", test::program_name}).status, 2) << "the other program's folder";
}

TEST(Profile, TracesOnlyWhenAskedAndChangesNoResult) {
  const test::TemporaryFolder folder;
  write_scene(folder.path / "bar.toml");
  const std::filesystem::path out = folder.path / "out" / "bar";
  const auto hashes = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"render", "bar.toml", "--no-images", "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    EXPECT_EQ(run(folder.path, arguments).status, 0);
    std::vector<std::string> list;
    const auto whole = test::profile_of(out);
    for (const auto& frame : whole["frames"]) list.push_back(frame["state_hash"]);
    return list;
  };
  const std::vector<std::string> traced = hashes({"--trace"});
  EXPECT_TRUE(std::filesystem::exists(out / "trace.json"));
  EXPECT_EQ(hashes({}), traced);
  EXPECT_FALSE(std::filesystem::exists(out / "trace.json"));
}

TEST(Profile, SaysWhichRepeatDiedAndReportsThoseThatAreWhole) {
  const test::TemporaryFolder folder;
  write_scene(folder.path / "bar.toml");
  const std::filesystem::path out = folder.path / "out" / "bar-profile";
  const std::vector<std::string> command = {"profile", "bar.toml", "--no-images", "--repeats", "200"};
  const Result interrupted = run(folder.path, command, out / "zones.json");
  EXPECT_EQ(interrupted.status, 130) << interrupted.err;
  const int whole = read_zones(out / "zones.json").repeats;
  EXPECT_NE(interrupted.err.find(fmt::format("supple: interrupted; {} of 200 repeats are whole\n", whole)),
            std::string::npos)
      << interrupted.err;
  EXPECT_NE(interrupted.out.find("\n  frame "), std::string::npos) << interrupted.out;

  rlimit usual{};
  getrlimit(RLIMIT_FSIZE, &usual);
  const rlimit small{60000, usual.rlim_max};  // the motion is larger: SIGXFSZ
  setrlimit(RLIMIT_FSIZE, &small);
  const Result died = run(folder.path, {"profile", "bar.toml", "--no-images", "--repeats", "2", "--frames", "100"});
  setrlimit(RLIMIT_FSIZE, &usual);
  EXPECT_EQ(died.status, 1);
  EXPECT_TRUE(died.err.ends_with(
      fmt::format("supple: repeat 1 of 2 was ended by signal {}; what it left is in out/bar-profile\n", SIGXFSZ)))
      << died.err;
}

// A program that runs against itself differs in nothing but noise.
TEST(Profile, RunsAnotherProgramInTurnAndComparesBoth) {
  const test::TemporaryFolder folder;
  write_scene(folder.path / "bar.toml");
  const auto against = [&](const std::string& program, const std::string& repeats) {
    return run(folder.path, {"profile", "bar.toml", "--no-images", "--threads", "1", "--repeats", repeats, "--out",
                             "own", "--against", program});
  };
  const Result both = against(test::program_name, "4");
  EXPECT_EQ(both.status, 0) << both.err;
  EXPECT_NE(both.out.find("B own"), std::string::npos) << both.out;
  EXPECT_EQ(read_zones(folder.path / "own" / "zones.json").repeats, 4);
  EXPECT_EQ(read_zones(folder.path / "own-against" / "zones.json").repeats, 4);
  EXPECT_EQ(against(test::program_name, "3").status, 2);
  const Result nowhere = against("nowhere", "4");
  EXPECT_EQ(nowhere.status, 2);
  EXPECT_NE(nowhere.err.find("--against nowhere: no such program"), std::string::npos) << nowhere.err;
}

TEST(Profile, ComparisonsRefuseWhatCannotBeCompared) {
  const test::TemporaryFolder folder;
  write_scene(folder.path / "bar.toml");
  const auto profile = [&](const std::string& out, const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"profile", "bar.toml", "--no-images", "--threads",
                                          "1",       "--json",   "--out",       out};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Result result = run(folder.path, arguments);
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_GT(nlohmann::json::parse(result.out)["zones"].size(), 5u);
  };
  const auto compare = [&](const std::string& a, const std::string& b) {
    return run(folder.path, {"profile", "--compare", a + "/zones.json", b + "/zones.json"});
  };
  profile("a", {"--repeats", "4"});
  profile("soft", {"--repeats", "3", "--set", "body.bar.material.mu=2e4"});
  const Result same = compare("a", "a");
  EXPECT_EQ(same.status, 0) << same.err;
  EXPECT_NE(same.out.find("No zone became slower or faster beyond the noise."), std::string::npos) << same.out;
  const Result differ = compare("a", "soft");
  EXPECT_EQ(differ.status, 2);
  EXPECT_NE(differ.err.find("cannot be compared: the scenes differ at /body/0/material/mu: 10000.0 and 20000.0"),
            std::string::npos)
      << differ.err;
  EXPECT_NE(differ.err.find("soft/zones.json: has 3 repeats; a comparison needs 4 or more (--repeats)"),
            std::string::npos)
      << differ.err;
  profile("stiff", {"--repeats", "4", "--set", "body.bar.material.mu=3e4"});
  const Result anyway = run(folder.path, {"profile", "--compare", "a/zones.json", "stiff/zones.json", "--anyway"});
  EXPECT_EQ(anyway.status, 0) << anyway.err;
  EXPECT_NE(
      anyway.err.find("note: compared all the same: the scenes differ at /body/0/material/mu: 10000.0 and 30000.0"),
      std::string::npos)
      << anyway.err;
  EXPECT_EQ(compare("a", "none").status, 2);
  EXPECT_EQ(compare("a", "a/../bar.toml/..").status, 2);
  EXPECT_EQ(run(folder.path, {"profile"}).status, 2);
  EXPECT_EQ(run(folder.path, {"profile", "bar.toml", "--resume"}).status, 2);
  EXPECT_EQ(run(folder.path, {"profile", "--compare", "a/zones.json"}).status, 2);
  EXPECT_EQ(run(folder.path, {"profile", "bar.toml", "--compare", "a/zones.json", "a/zones.json"}).err,
            "profile --compare: SCENE|REPLAY has no meaning with it\n");
  EXPECT_EQ(run(folder.path, {"profile", "--compare", "a", "a", "--frames", "3"}).err,
            "profile --compare: --frames has no meaning with it\n");
}

}  // namespace profile_test
}  // namespace supple
