// Tests `supple compare` and what it reads: point caches and the folders of runs.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "output/motion/point_cache.h"
#include "output/run/run_comparison.h"
#include "support/bodies.h"
#include "support/program.h"

namespace supple {
namespace compare_test {

using test::Result;
using test::run;

std::string refusal_of(const std::filesystem::path& path) {
  try {
    PointCacheReader reader(path);
    for (int frame = 0; frame < reader.frames(); ++frame) (void)reader.frame(frame);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

void write_bytes(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

// Returns two points, which move through three frames.
Positions points_of(int frame) {
  Positions points(2, 3);
  points << 1, 2, 3, 4, 5, 6;
  return points * (frame + 1);
}

std::filesystem::path small_cache(const std::filesystem::path& folder) {
  PointCacheWriter writer(folder / "body.pc2", 2);
  for (int frame = 0; frame < 3; ++frame) writer.add(points_of(frame));
  return folder / "body.pc2";
}

TEST(PointCache, GivesBackTheFramesThatWereWritten) {
  const test::TemporaryFolder folder;
  PointCacheReader reader(small_cache(folder.path));
  EXPECT_EQ(reader.points(), 2);
  ASSERT_EQ(reader.frames(), 3);
  for (const int frame : {2, 0, 1}) EXPECT_EQ(reader.frame(frame), points_of(frame)) << frame;
}

TEST(PointCache, RefusesDamagedFilesByName) {
  const test::TemporaryFolder folder;
  const std::filesystem::path path = small_cache(folder.path), broken = folder.path / "broken.pc2";
  const std::string whole = test::read_file(path);
  const auto refusal = [&](const std::string& bytes) {
    write_bytes(broken, bytes);
    const std::string said = refusal_of(broken);
    EXPECT_TRUE(said.starts_with(broken.string() + ": ")) << said;
    return said.substr(broken.string().size() + 2);
  };
  EXPECT_EQ(refusal_of(folder.path / "none.pc2"), (folder.path / "none.pc2").string() + ": cannot be read");
  EXPECT_EQ(refusal(""), "is not a PC2 point cache");
  EXPECT_EQ(refusal("POINTCACHE3" + whole.substr(11)), "is not a PC2 point cache");
  EXPECT_EQ(refusal(whole.substr(0, 31)), "is not a PC2 point cache");
  EXPECT_EQ(refusal(whole.substr(0, whole.size() - 1)),
            "is cut short: it holds 103 bytes, and 3 frames of 2 points need 104");
  EXPECT_EQ(refusal(whole + std::string(25, '\0')),
            "is damaged: it holds 129 bytes, and 3 frames of 2 points need 104");
  std::string other = whole;
  other[12] = 2;
  EXPECT_EQ(refusal(other), "is of version 2; this program reads version 1");
  other = whole;
  other[31] = char(0x80);
  EXPECT_TRUE(refusal(other).starts_with("is damaged: its header says 2 points and -"));
  other = whole;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::memcpy(other.data() + 32 + 24 + 4, &nan, 4);
  EXPECT_EQ(refusal(other), "is damaged: a number of frame 1 is not finite");
}

TEST(PointCache, ReadsWhatAKilledRunLeft) {
  const test::TemporaryFolder folder;
  const std::filesystem::path path = small_cache(folder.path);
  write_bytes(path, test::read_file(path) + "half");
  EXPECT_EQ(PointCacheReader(path).frames(), 3);
}

// Writes a run's folder by hand: its bodies have two points, of which the second is moved by `moved` in frame 1.
struct HandMade {
  std::vector<std::string> bodies = {"soft"};
  int frames = 3;
  double moved = 0;
  double step_ms = 10;
  std::string scene = R"({"body":[{"name":"soft","material":{"mu":2e4}}],"gravity":[0,-9.81,0]})";

  void write(const std::filesystem::path& folder) const {
    std::filesystem::create_directories(folder / "motion");
    write_bytes(folder / "run.json",
                R"({"program":{"version":"1"},"command":["x"],"ended":"done","scene":)" + scene + "}");
    std::vector<FrameRow> rows;
    for (int frame = 0; frame < frames; ++frame) {
      FrameRow& row = rows.emplace_back();
      row.frame = frame;
      row.time_s = frame / 30.0;
      row.step_ms = step_ms;
      row.state_hash = std::uint64_t(frame + (frame > 0 ? moved * 1e6 : 0));
      for (const std::string& body : bodies) {
        row.bodies.emplace_back();
        row.bodies.back().name = body;
      }
    }
    write_bytes(folder / "profile.json", profile_json(rows));
    for (const std::string& body : bodies) {
      PointCacheWriter writer(folder / "motion" / (body + ".pc2"), 2);
      for (int frame = 0; frame < frames; ++frame) {
        Positions points(2, 3);
        points << 0, 0, 0, 3, 4, 0;
        if (frame == 1) points(1, 2) = moved;
        writer.add(points);
      }
    }
  }
};

TEST(Comparison, FindsDistancesByFrame) {
  const test::TemporaryFolder folder;
  HandMade{}.write(folder.path / "a");
  HandMade{.moved = 0.5, .step_ms = 20}.write(folder.path / "b");
  const RunComparison c = compare_runs(read_run(folder.path / "a"), read_run(folder.path / "b"));
  EXPECT_EQ(c.first_difference, 1);
  ASSERT_EQ(c.bodies.size(), 1u);
  EXPECT_EQ(c.bodies[0].size, 5);
  EXPECT_EQ(c.bodies[0].worst_frame, 1);
  EXPECT_EQ(c.bodies[0].distance[0].largest, 0);
  EXPECT_EQ(c.bodies[0].distance[1].largest, 0.5);
  EXPECT_NEAR(c.bodies[0].distance[1].rms, 0.5 / std::sqrt(2.0), 1e-12);
  EXPECT_EQ(c.step_ms_a, 10);
  EXPECT_EQ(c.step_ms_b, 20);
  EXPECT_TRUE(c.differences.empty());
  EXPECT_FALSE(c.same_states());
}

TEST(Comparison, OfOtherBodiesKeepsTheTimesOfThoseThatBothHave) {
  const test::TemporaryFolder folder;
  HandMade{.bodies = {"soft", "left"}}.write(folder.path / "a");
  HandMade{.bodies = {"soft", "right"}}.write(folder.path / "b");
  for (const char* name : {"a", "b"}) {
    const std::filesystem::path file = folder.path / name / "profile.json";
    std::vector<FrameRow> rows = read_profile(file);
    for (FrameRow& row : rows) row.bodies[0].step_ms = *name == 'a' ? 4 : 6;
    write_bytes(file, profile_json(rows));
  }
  const Result result = run(folder.path, {"compare", "a", "b"});
  EXPECT_NE(result.out.find("  median step     of the bodies that both have; the others' times cannot be compared\n"
                            "    soft          4.000 ms in A, 6.000 ms in B: B takes 1.500 times as long\n"),
            std::string::npos)
      << result.out;
  EXPECT_NE(result.out.find("only in A\n"), std::string::npos);
  const Result same = run(folder.path, {"compare", "a", "a"});
  EXPECT_NE(same.out.find("  median step     10.000 ms in A, 10.000 ms in B"), std::string::npos) << same.out;
}

TEST(Comparison, TellsOfOtherLengthsAndBodies) {
  const test::TemporaryFolder folder;
  HandMade{}.write(folder.path / "a");
  HandMade{.frames = 2}.write(folder.path / "short");
  HandMade{.bodies = {"soft", "stiff"}}.write(folder.path / "more");
  const RunRecord a = read_run(folder.path / "a");
  EXPECT_TRUE(compare_runs(a, a).same_states());
  const RunComparison shorter = compare_runs(a, read_run(folder.path / "short"));
  EXPECT_EQ(shorter.frames, 2);
  EXPECT_FALSE(shorter.first_difference);
  EXPECT_FALSE(shorter.same_states());
  const RunComparison more = compare_runs(a, read_run(folder.path / "more"));
  EXPECT_EQ(more.only_b, std::vector<std::string>{"stiff"});
  EXPECT_FALSE(more.same_states());
}

TEST(Comparison, FindsMotionThatIsNotThatOfTheStates) {
  const test::TemporaryFolder folder;
  for (const char* name : {"a", "b", "c"}) HandMade{.bodies = {"soft", "stiff"}}.write(folder.path / name);
  HandMade{.moved = 0.5}.write(folder.path / "moved");
  HandMade{.frames = 4}.write(folder.path / "long");
  const auto put = [&](const std::string& from, const std::string& to) {
    std::filesystem::copy_file(folder.path / from / "motion/soft.pc2", folder.path / to / "motion/stiff.pc2",
                               std::filesystem::copy_options::overwrite_existing);
  };
  put("moved", "b");
  const Result content = run(folder.path, {"compare", "a", "b"});
  EXPECT_EQ(content.status, 1) << content.err;
  EXPECT_NE(content.out.find("states          the same in all 3 frames\n  motion          motion/stiff.pc2 differs "
                             "from frame 1 on, though the states do not differ there: a file was changed\n"),
            std::string::npos)
      << content.out;
  const auto json = nlohmann::json::parse(run(folder.path, {"compare", "a", "b", "--json"}).out);
  EXPECT_TRUE(json["same_states"].get<bool>());
  EXPECT_FALSE(json["same_motion"].get<bool>());
  EXPECT_EQ(json["bodies"][1]["first_difference"], 1);
  EXPECT_TRUE(json["bodies"][0]["first_difference"].is_null());

  put("long", "c");
  const Result length = run(folder.path, {"compare", "a", "c"});
  EXPECT_EQ(length.status, 1) << length.err;
  EXPECT_NE(length.out.find("motion/stiff.pc2 has 3 frames in A and 4 in B"), std::string::npos) << length.out;

  // Where the states differ too, the motion agrees with the states, so no changed file is reported.
  const Result states = run(folder.path, {"compare", "long", "moved"});
  EXPECT_EQ(states.status, 1) << states.err;
  EXPECT_EQ(states.out.find("though the states"), std::string::npos) << states.out;
  const auto both = nlohmann::json::parse(run(folder.path, {"compare", "long", "moved", "--json"}).out);
  EXPECT_FALSE(both["same_states"].get<bool>());
  EXPECT_FALSE(both["same_motion"].get<bool>());
}

TEST(Comparison, NamesDifferencesByPath) {
  const auto found = [](const char* a, const char* b) {
    std::string text;
    for (const JsonDifference& d : differing_values(a, b)) text += d.path + ": " + d.a + " / " + d.b + "; ";
    return text;
  };
  EXPECT_EQ(found(R"({"a":1})", R"({"a":1})"), "");
  EXPECT_EQ(found(R"({"body":[{"name":"x","mu":1},{"name":"y"}]})", R"({"body":[{"name":"y"},{"name":"x","mu":2}]})"),
            "body.x.mu: 1 / 2; ");
  EXPECT_EQ(found(R"({"gravity":[0,1],"key":[{"t":0}]})", R"({"gravity":[0,2],"key":[{"t":1}],"more":{"k":1}})"),
            "gravity: [0,1] / [0,2]; key.0.t: 0 / 1; more: nothing / {\"k\":1}; ");
  EXPECT_EQ(found(R"({"a":[[0,1],[2,3]]})", R"({"a":[[0,1],[2,4],[5,6]]})"),
            "a.1: [2,3] / [2,4]; a.2: nothing / [5,6]; ");
  EXPECT_EQ(found("not JSON", "{}"), "the whole text: not JSON / {}; ");
  EXPECT_EQ(json_differences(R"({"a":1,"b":2})", R"({"a":3,"c":4})"),
            (std::vector<std::string>{"a: 1 and 3", "b: 2 and nothing", "c: nothing and 4"}));
  EXPECT_EQ(json_differences(R"({"a":1,"b":2})", R"({"a":3,"c":4})", 1).size(), 1u);
  EXPECT_EQ(found(R"({"a":{"b":1}})", R"({"a":2})"), "a: {\"b\":1} / 2; ");
}

TEST(Comparison, RefusesFoldersThatAreNotWholeRuns) {
  const test::TemporaryFolder folder;
  HandMade{}.write(folder.path / "a");
  const auto refusal = [&](const std::string& name) {
    const Result result = run(folder.path, {"compare", "a", name});
    EXPECT_EQ(result.status, 2) << result.out;
    return result.err;
  };
  EXPECT_EQ(refusal("none"), "none: no such folder\n");
  std::filesystem::create_directory(folder.path / "empty");
  EXPECT_EQ(refusal("empty"), "empty: there is no run.json in it: this is not the folder of a run\n");
  HandMade{}.write(folder.path / "b");
  std::filesystem::remove(folder.path / "b" / "profile.json");
  EXPECT_EQ(refusal("b"), "b: there is no profile.json in it: the run did not come to its end (done)\n");
  HandMade{}.write(folder.path / "b");
  write_bytes(folder.path / "b" / "run.json", "{");
  EXPECT_EQ(refusal("b"), "b/run.json: is damaged: not a JSON object\n");
  HandMade{}.write(folder.path / "b");
  HandMade{.frames = 1}.write(folder.path / "c");
  std::filesystem::copy_file(folder.path / "c/motion/soft.pc2", folder.path / "b/motion/soft.pc2",
                             std::filesystem::copy_options::overwrite_existing);
  EXPECT_EQ(refusal("b"), "b/motion/soft.pc2: holds 1 of the 3 frames that profile.json has\n");
  EXPECT_EQ(run(folder.path, {"compare", "a", "a", "--csv", "none/x.csv"}).status, 2);
}

TEST(Comparison, ComparesRunsOfTheProgram) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path / "bar.toml") << R"(frames = 4
[[body]]
name = "bar"
box = { extent = [0.4, 0.1, 0.1], cells = [4, 2, 2] }
material = { model = "neo-hookean", young = 1e5, poisson = 0.3 }
[[body.handles]]
name = "end"
select = { box = [[0, 0, 0], [0.1, 1, 1]] }
)";
  const auto film = [&](const std::string& out, const std::vector<std::string>& more) {
    std::vector<std::string> words = {"render", "bar.toml", "--no-images", "--quiet", "--out", out};
    words.insert(words.end(), more.begin(), more.end());
    ASSERT_EQ(run(folder.path, words).status, 0);
  };
  film("a", {"--threads", "1"});
  film("same", {"--threads", "2"});
  film("other", {"--threads", "1", "--set", "body.bar.material.young=2e5"});
  film("finer", {"--threads", "1", "--set", "body.bar.box.cells=[5,2,2]"});

  const Result same = run(folder.path, {"compare", "a", "same"});
  EXPECT_EQ(same.status, 0) << same.err;
  EXPECT_NE(same.out.find("the same in all 4 frames"), std::string::npos) << same.out;
  EXPECT_NE(same.out.find("machine.threads: 1 and 2"), std::string::npos) << same.out;

  const Result other = run(folder.path, {"compare", "a", "other", "--csv", "d.csv"});
  EXPECT_EQ(other.status, 1) << other.err;
  EXPECT_NE(other.out.find("differ from frame 0 on"), std::string::npos) << other.out;
  EXPECT_NE(other.out.find("scene.body.bar.material.young: 100000.0 and 200000.0\n"), std::string::npos) << other.out;
  std::istringstream csv(test::read_file(folder.path / "d.csv"));
  std::string line;
  std::vector<std::string> lines;
  while (std::getline(csv, line)) lines.push_back(line);
  ASSERT_EQ(lines.size(), 5u);
  EXPECT_EQ(lines[0], "frame,time_s,body,largest_m,rms_m,largest_over_size,rms_over_size");
  EXPECT_TRUE(lines[4].starts_with("3,0.1333")) << lines[4];

  const Result finer = run(folder.path, {"compare", "a", "finer", "--json"});
  EXPECT_EQ(finer.status, 1) << finer.err;
  const auto json = nlohmann::json::parse(finer.out);
  EXPECT_EQ(json["bodies"][0]["vertices"]["a"], 45);
  EXPECT_EQ(json["bodies"][0]["vertices"]["b"], 54);
  EXPECT_FALSE(json["bodies"][0].contains("largest_m"));
  EXPECT_FALSE(json["same_states"].get<bool>());
}

}  // namespace compare_test
}  // namespace supple
