#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "output/files/png_file.h"
#include "output/files/whole_file.h"
#include "output/motion/point_cache.h"
#include "output/pages/page_parts.h"
#include "output/run/frame_rows.h"
#include "output/run/profile.h"
#include "output/run/row_tally.h"
#include "output/run/run_folder.h"
#include "support/bodies.h"

namespace supple {
namespace output_test {

TEST(Png, GivesBackItsPixelsAndLeavesNoTemporaryFile) {
  const test::TemporaryFolder folder;
  std::vector<std::uint8_t> pixels(3 * 7 * 5);
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<std::uint8_t>(37 * i);
  write_png(folder.path / "a.png", 7, 5, pixels);
  const PngImage read = read_png(folder.path / "a.png");
  EXPECT_EQ(read.width, 7);
  EXPECT_EQ(read.height, 5);
  EXPECT_EQ(read.rgb, pixels);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path), {}), 1);
}

TEST(WholeFile, SaysWhatTheDiskSaid) {
  try {
    write_whole_file("/proc/nothing/here", std::string_view("x"));
    FAIL();
  } catch (const RunError& error) {
    EXPECT_EQ(std::string(error.what()), "/proc/nothing/here: cannot be created: No such file or directory");
  }
}

TEST(PointCache, IsValidAfterEveryFrame) {
  const test::TemporaryFolder folder;
  PointCacheWriter writer(folder.path / "body.pc2", 2);
  Positions points(2, 3);
  points << 1, 2, 3, 4, 5, 6;
  for (int frame = 1; frame <= 3; ++frame) {
    writer.add(points * frame);
    const std::string bytes = test::read_file(folder.path / "body.pc2");
    ASSERT_EQ(bytes.size(), 32u + frame * 24u);
    std::int32_t samples = 0;
    std::memcpy(&samples, bytes.data() + 28, 4);
    EXPECT_EQ(samples, frame);
    float last = 0;
    std::memcpy(&last, bytes.data() + bytes.size() - 4, 4);
    EXPECT_EQ(last, 6.0f * frame);
  }
}

TEST(PointCache, GoesOnBehindTheFramesItKeepsAndNoOthers) {
  const test::TemporaryFolder folder;
  const std::filesystem::path path = folder.path / "body.pc2";
  Positions points(2, 3);
  points << 1, 2, 3, 4, 5, 6;
  {
    PointCacheWriter writer(path, 2);
    for (int frame = 1; frame <= 5; ++frame) writer.add(points * frame);
  }
  const std::string whole = test::read_file(path);
  {
    PointCacheWriter writer(path, 2, 3);
    for (int frame = 4; frame <= 5; ++frame) writer.add(points * frame);
  }
  EXPECT_EQ(test::read_file(path), whole);
  EXPECT_THROW(PointCacheWriter(path, 2, 6), RunError);
  EXPECT_THROW(PointCacheWriter(path, 3, 2), RunError);
  std::filesystem::resize_file(path, 32 + 2 * 24);  // its header still says five
  EXPECT_THROW(PointCacheWriter(path, 2, 3), RunError);
  EXPECT_NO_THROW(PointCacheWriter(path, 2, 2));
}

TEST(Profile, PercentilesAreNearestRanks) {
  std::vector<double> values;
  for (int i = 100; i >= 1; --i) values.push_back(i);
  const Distribution d = distribution_of(values);
  EXPECT_EQ(d.p50, 50);
  EXPECT_EQ(d.p95, 95);
  EXPECT_EQ(d.p99, 99);
  EXPECT_EQ(d.max, 100);
  EXPECT_EQ(d.mean, 50.5);
}

TEST(Profile, LeavesOutWhatWasNotUsedAndTheFirstFrame) {
  FrameRow row;
  row.step_ms = 100;
  row.bodies.push_back({});
  std::vector<FrameRow> rows(3, row);
  rows[1].step_ms = rows[2].step_ms = 2;
  const std::string json = profile_json(rows);
  for (const char* absent : {"render_ms", "compress_ms", "\"error\"", "jiggle", "collide_ms", "\"pairs\"", "\"deep\""})
    EXPECT_EQ(json.find(absent), std::string::npos) << absent;
  EXPECT_EQ(summarize(rows)[0].rest.max, 2);
  EXPECT_EQ(summarize(rows)[0].first, 100);
  EXPECT_EQ(summarize({rows[0]})[0].rest.total, 0);  // a film of one frame has no further frames
  rows[0].bodies[0].error_measured = true;           // it was measured, but no error could be computed
  EXPECT_NE(profile_json(rows).find("\"error\": null"), std::string::npos);
}

TEST(Profile, RowsComeBackFromTheirText) {
  FrameRow row;
  row.frame = 7;
  row.time_s = 8.0 / 30;
  row.step_ms = 12.25;
  row.render_ms = 3.5;
  row.compress_ms = 4.25;
  row.state_hash = 0xfedcba9876543210u;
  BodyRow body;
  body.name = "soft";
  body.objective_end = 0.1 + 0.2;
  body.error_measured = true;
  body.reference_converged = false;
  body.jiggle = 1.0 / 3;
  body.skin_excess = 1.75;
  body.in_picture = 0.25;
  body.inverted = 2;
  body.energy = {1, 2, 3.5};
  body.contact = {0.5, 4, 3, 2, 1e-3, {{"ground", 1e-3, 12.5}, {"press", 0, 0}}};
  body.stop_reason = "round-off";
  body.budget_cuts = {{4, -1}, {2, 1}};
  row.bodies = {body, BodyRow{}};
  row.pairs = {{{"soft", "other"}, 12, 0.1 + 0.2, 1.0 / 3}, {{"soft", "third"}, 1, 0.05, 0, true, true}};
  row.deep = {{{"other", "third"}, 0.02, {0.1, -0.2, 0.3}}};
  const std::string line = row_line(row);
  EXPECT_EQ(line.find('\n'), std::string::npos);
  const FrameRow back = row_of_line(line, "a line");
  EXPECT_EQ(row_line(back), line);
  EXPECT_EQ(back.state_hash, row.state_hash);
  EXPECT_EQ(back.bodies[0].objective_end, body.objective_end);  // all seventeen digits
  EXPECT_TRUE(back.bodies[0].error_measured && !back.bodies[0].error);
  EXPECT_TRUE(!back.bodies[0].reference_converged && back.bodies[1].reference_converged);
  EXPECT_EQ(back.bodies[0].budget_cuts, body.budget_cuts);
  EXPECT_EQ(back.bodies[0].skin_excess, 1.75);
  EXPECT_EQ(back.bodies[0].in_picture, 0.25);
  ASSERT_EQ(back.pairs.size(), 2u);
  EXPECT_EQ(back.pairs[0].bodies, row.pairs[0].bodies);
  EXPECT_EQ(back.pairs[0].contacts, 12);
  EXPECT_EQ(back.pairs[0].penetration, row.pairs[0].penetration);
  EXPECT_EQ(back.pairs[0].force, row.pairs[0].force);
  EXPECT_FALSE(back.pairs[0].expected);
  EXPECT_FALSE(back.pairs[0].coming_apart);
  EXPECT_TRUE(back.pairs[1].expected);
  EXPECT_TRUE(back.pairs[1].coming_apart);
  ASSERT_EQ(back.deep.size(), 1u);
  EXPECT_EQ(back.deep[0].bodies, row.deep[0].bodies);
  EXPECT_EQ(back.deep[0].share, 0.02);
  EXPECT_EQ(back.deep[0].place, row.deep[0].place);
  EXPECT_FALSE(back.draw_ms || back.bodies[1].contact || back.bodies[1].jiggle || back.bodies[1].skin_excess);

  const test::TemporaryFolder folder;
  write_whole_file(folder.path / "profile.json", profile_json({row, back}));
  EXPECT_EQ(profile_json(read_profile(folder.path / "profile.json")), profile_json({row, back}));
  EXPECT_THROW(row_of_line("{}", "a line"), InputError);
  EXPECT_THROW(row_of_line(line.substr(0, line.size() / 2), "a line"), InputError);
  EXPECT_THROW(read_profile(folder.path / "none.json"), InputError);
}

// A long film's profile must not need much memory.
TEST(Profile, IsWrittenFrameByFrame) {
  FrameRow row;
  row.bodies.resize(3);
  for (const std::size_t frames : {0, 1, 1000}) {
    std::size_t largest = 0;
    std::string text;
    const std::vector<FrameRow> rows(frames, row);
    write_profile(FrameRows(rows), RowTally(rows), "all is well", [&](std::string_view piece) {
      largest = std::max(largest, piece.size());
      text += piece;
    });
    EXPECT_LT(largest, 4000u) << frames;
    EXPECT_EQ(nlohmann::ordered_json::parse(text).dump(1) + "\n", text) << "as if it were written at once";
  }
}

TEST(Profile, WarnsOfASkinThatIsStretchedBeyondItsElements) {
  std::vector<FrameRow> rows(3);
  for (int frame = 0; frame < 3; ++frame) {
    rows[frame].frame = frame;
    rows[frame].bodies = {BodyRow{}};
    rows[frame].bodies[0].name = "soft";
  }
  rows[0].bodies[0].skin_excess = 1.4;
  EXPECT_TRUE(warnings_of(rows).empty());
  rows[1].bodies[0].skin_excess = 2.5;
  ASSERT_EQ(warnings_of(rows).size(), 1u);
  EXPECT_EQ(
      warnings_of(rows)[0],
      "the skin of body 'soft' was stretched 2.5 times as much as its elements in frame 1; more vertices bring the "
      "elements closer to the skin");
}

TEST(Profile, WarnsOfBodiesThatThePicturesDoNotShow) {
  std::vector<FrameRow> rows(4);
  for (int frame = 0; frame < 4; ++frame) {
    rows[frame].frame = frame;
    for (const char* name : {"first", "second"}) {
      rows[frame].bodies.emplace_back().name = name;
      rows[frame].bodies.back().in_picture = 1.0;
    }
  }
  const auto words = [&] {
    std::string all;
    for (const std::string& warning : warnings_of(rows)) all += warning.substr(0, warning.find(';')) + "\n";
    return all;
  };
  EXPECT_EQ(words(), "");
  rows[2].bodies[1].in_picture = 0.4;
  EXPECT_EQ(words(),
            "the picture's border cuts body 'second' in 1 of 4 frames, first in frame 2: it shows as little as 40 % of "
            "it\n");
  rows[3].bodies[1].in_picture = 0.0;
  EXPECT_EQ(words(), "body 'second' is out of the picture in 1 of 4 frames, first in frame 3\n");
  for (FrameRow& row : rows) row.bodies[1].in_picture = 0.0;
  EXPECT_EQ(words(), "body 'second' is in no picture\n");
  for (FrameRow& row : rows) row.bodies[0].in_picture = 0.0;
  EXPECT_EQ(words(), "no picture shows a body\n");
  for (FrameRow& row : rows) row.bodies[0].in_picture.reset();  // it was not drawn
  EXPECT_EQ(words(), "body 'second' is in no picture\n");
}

TEST(Profile, TellsWhatEachColliderDidAndWarnsOfDepthsAboveAHundredth) {
  std::vector<FrameRow> rows(4);
  for (int frame = 0; frame < 4; ++frame) {
    rows[frame].frame = frame;
    BodyRow soft;
    soft.name = "soft";
    const double deep = frame == 2 ? 0.05 : frame == 3 ? 0.02 : 0;
    soft.contact = {0, 0, 0, 0, deep, {{"ground", 0.009, 10.0 * frame}, {"press", deep, 0}, {"wall", 0, 0}}};
    rows[frame].bodies = {soft};
  }
  const std::vector<std::string> warnings = penetration_warnings(rows);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(
      warnings[0].find("body 'soft' was up to 5 % of its size deep inside collider 'press' (at frame 2; above 1 % "
                       "in 2 of 4 frames)"),
      std::string::npos)
      << warnings[0];
  const std::string table = profile_table(rows);
  const auto line = [&](const std::string& collider) {
    const std::size_t at = table.find("  soft          " + collider);
    return at == std::string::npos ? "" : table.substr(at, table.find('\n', at) - at);
  };
  EXPECT_EQ(line("ground"), "  soft          ground              9.0e-03         0            15            30");
  EXPECT_EQ(line("press"), "  soft          press               5.0e-02         2             0             0");
  EXPECT_EQ(line("wall"), "");
}

// Four frames in which 'a' and 'b' touch, except in the first, and are deep in the last two.
std::vector<FrameRow> rows_of_a_pair() {
  std::vector<FrameRow> rows(4);
  for (int frame = 0; frame < 4; ++frame) {
    rows[frame].frame = frame;
    rows[frame].bodies.resize(2);
    const double depth = frame == 2 ? 0.05 : frame == 3 ? 0.02 : 0.005;
    if (frame > 0) rows[frame].pairs = {{{"a", "b"}, 3, depth, 10.0 * frame}};
  }
  return rows;
}

TEST(Profile, TellsHowPairsOfBodiesTouched) {
  std::vector<FrameRow> rows = rows_of_a_pair();
  rows[1].pairs.push_back({{"a", "c"}, 1, 0, 0});
  const std::string table = profile_table(rows);
  EXPECT_NE(table.find("\n  body          other body      penetration  at frame force N, mean          most\n"
                       "  a             b                   5.0e-02         2            15            30\n"
                       "  a             c                   0.0e+00         -             0             0\n"),
            std::string::npos)
      << table;
  for (FrameRow& row : rows) row.pairs.clear();
  EXPECT_EQ(profile_table(rows).find("other body"), std::string::npos);
}

TEST(Profile, WarnsOfPairsOfBodiesThatAreDeepInEachOther) {
  std::vector<FrameRow> rows = rows_of_a_pair();
  EXPECT_EQ(warnings_of(rows),
            std::vector<std::string>{
                "bodies 'a' and 'b' were up to 5 % of the smaller one's size deep in each other (at frame 2; above 1 % "
                "in 2 of 4 frames): substeps or more solver.iterations make that less"});
  rows[2].pairs[0].expected = true;
  ASSERT_EQ(warnings_of(rows).size(), 1u);
  EXPECT_NE(warnings_of(rows)[0].find("up to 2 % of the smaller one's size deep in each other (at frame 3; above 1 % "
                                      "in 1 of 4 frames)"),
            std::string::npos)
      << warnings_of(rows)[0];
  rows[3].pairs[0].expected = true;
  EXPECT_TRUE(warnings_of(rows).empty());
  EXPECT_NE(profile_table(rows).find("5.0e-02         2"), std::string::npos) << "the table tells it all the same";
}

TEST(Profile, WarnsOfDepthsThatContactsDidNotShowAndOncePerPair) {
  std::vector<FrameRow> rows = rows_of_a_pair();
  rows[1].deep = {{{"b", "c"}, 0.03, {0.5, 0.25, -1}}};
  const std::string missed =
      "bodies 'b' and 'c' were 3 % of the smaller one's size deep in each other in frame 1, at [0.5, 0.25, -1], and "
      "their contacts never showed more than 1 %: substeps or more solver.iterations make that less";
  ASSERT_EQ(warnings_of(rows).size(), 2u);
  EXPECT_EQ(warnings_of(rows)[1], missed);
  rows[1].deep = {{{"a", "b"}, 0.03, {0, 0, 0}}};
  ASSERT_EQ(warnings_of(rows).size(), 1u);
  EXPECT_NE(warnings_of(rows)[0].find("up to 5 % of the smaller one's size deep in each other (at frame 2;"),
            std::string::npos)
      << warnings_of(rows)[0];
  rows[1].deep[0].share = 0.2;
  ASSERT_EQ(warnings_of(rows).size(), 1u);
  EXPECT_NE(warnings_of(rows)[0].find("up to 20 % of the smaller one's size deep in each other (at frame 1;"),
            std::string::npos)
      << warnings_of(rows)[0];
}

TEST(RunFolder, TakesOverItsOwnAndRefusesWhatOthersLeft) {
  const test::TemporaryFolder folder;
  const std::filesystem::path run = folder.path / "run";
  RunFolder(run).write_info({});
  write_whole_file(run / "frames" / "000000.png", std::string_view("old"));
  const RunFolder again(run);
  EXPECT_FALSE(std::filesystem::exists(run / "frames" / "000000.png"));
  std::filesystem::create_directory(folder.path / "photos");
  write_whole_file(folder.path / "photos" / "me.png", std::string_view("x"));
  EXPECT_THROW(RunFolder(folder.path / "photos"), InputError);
  EXPECT_TRUE(std::filesystem::exists(folder.path / "photos" / "me.png"));
  EXPECT_THROW(RunFolder(folder.path / "photos" / "me.png"), InputError);
}

TEST(RunFolder, RemovesOnlyWhatRunsWrite) {
  const test::TemporaryFolder folder;
  const std::filesystem::path run = folder.path / "run";
  RunFolder(run).write_info({});
  std::filesystem::create_directories(run / "fields");
  const std::vector<std::filesystem::path> own = {"frames/000000.png", "frames/000001.png.part", "motion/bar.pc2",
                                                  "motion/bar.obj",    "motion/colliders.csv",   "fields/bar.pvd",
                                                  "states/bar-000003", "checkpoint/rows.jsonl",  "checkpoint/state"},
                                           others = {"motion/mine.blend", "frames/mine.txt", "frames/sub/000000.png",
                                                     "states/mine-000003/notes.txt"};
  for (const char* made : {"frames/sub", "states/mine-000003", "states/bar-000003"})
    std::filesystem::create_directories(run / made);
  write_whole_file(run / "states/bar-000003/q.npy", std::string_view("x"));
  const std::filesystem::path page = run / "index.html";
  write_whole_file(page, page_begin("a film", "") + page_end(""));
  for (const auto* files : {&own, &others}) {
    for (const std::filesystem::path& file : *files) {
      if (!std::filesystem::is_directory(run / file)) write_whole_file(run / file, std::string_view("x"));
    }
  }
  const RunFolder going_on(run, 1);
  EXPECT_TRUE(std::filesystem::exists(run / own[0]));
  EXPECT_FALSE(std::filesystem::exists(run / own[1]));
  EXPECT_TRUE(std::filesystem::exists(page));
  const RunFolder anew(run);
  EXPECT_FALSE(std::filesystem::exists(page)) << "the page of the film before is still there";
  for (const std::filesystem::path& file : own) EXPECT_FALSE(std::filesystem::exists(run / file)) << file;
  for (const std::filesystem::path& file : others) EXPECT_TRUE(std::filesystem::exists(run / file)) << file;
  write_whole_file(page, std::string_view("<!DOCTYPE html><title>somebody's own</title>"));
  EXPECT_TRUE(std::filesystem::exists(RunFolder(run).path() / "index.html"));
}

TEST(RunFolder, TakesOverWhatARunThatWasKilledAtItsBeginningLeft) {
  const test::TemporaryFolder folder;
  const std::filesystem::path run = folder.path / "run";
  for (const char* made : {"frames", "motion", "checkpoint"}) std::filesystem::create_directories(run / made);
  write_whole_file(run / "run.json.part", std::string_view(""));
  EXPECT_NO_THROW(RunFolder{run});
  std::filesystem::remove(run / "run.json");
  write_whole_file(run / "frames" / "mine.txt", std::string_view("x"));
  EXPECT_THROW(RunFolder{run}, InputError);
}

}  // namespace output_test
}  // namespace supple
