// Tests sweeps as a user runs them: all points at once, point by point, interrupted, and with a point that fails.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include "film/pictures/contact_sheet.h"
#include "film/plan/shipped_files.h"
#include "output/files/png_file.h"
#include "output/pages/report_table.h"
#include "support/bodies.h"
#include "support/program.h"

namespace supple {
namespace sweep_verb_test {

using test::Result;
using test::run;

constexpr const char* bar_scene = R"(frames = 4
[[body]]
name = "bar"
box = { extent = [1, 0.2, 0.2], cells = [6, 2, 2] }
material = { model = "corotated", young = 1e4, poisson = 0.3 }
[[body.handles]]
name = "left"
select = { box = [[0, 0, 0], [0, 1, 1]] }
[output]
width = 128
height = 72
samples = 1
)";

constexpr const char* four_points = R"([sweep.values]
"body.bar.material.young" = [1e4, 1e5]
"body.bar.material.poisson" = [0.0, 0.4]
)";

void write_scene(const test::TemporaryFolder& folder, const std::string& more) {
  std::ofstream(folder.path / "bar.toml") << bar_scene << more;
}

std::vector<std::vector<std::string>> table_of(const test::TemporaryFolder& folder) {
  return read_csv(folder.path / "out" / "bar-sweep" / "sweep.csv");
}

std::size_t column(const std::vector<std::vector<std::string>>& table, const std::string& name) {
  const auto place = std::find(table[0].begin(), table[0].end(), name);
  EXPECT_NE(place, table[0].end()) << name;
  return std::size_t(place - table[0].begin());
}

TEST(SweepVerb, CountsAndListsItsPoints) {
  const test::TemporaryFolder folder;
  write_scene(folder, four_points);
  EXPECT_EQ(run(folder.path, {"sweep", "bar.toml", "--count"}).out, "4\n");
  EXPECT_EQ(run(folder.path, {"sweep", "bar.toml", "--list"}).out,
            "0  body.bar.material.young=10000  body.bar.material.poisson=0\n"
            "1  body.bar.material.young=10000  body.bar.material.poisson=0.4\n"
            "2  body.bar.material.young=100000  body.bar.material.poisson=0\n"
            "3  body.bar.material.young=100000  body.bar.material.poisson=0.4\n");
  EXPECT_FALSE(std::filesystem::exists(folder.path / "out"));
  const Result beyond = run(folder.path, {"sweep", "bar.toml", "--index", "4"});
  EXPECT_EQ(beyond.status, 2);
  EXPECT_EQ(beyond.err, "--index 4: the sweep has 4 points, 0 to 3\n");
  EXPECT_EQ(run(folder.path, {"sweep", "bar.toml", "--index", "0", "--merge"}).status, 2);
}

TEST(SweepVerb, GivesTheSameTableWhoeverRunsThePoints) {
  const test::TemporaryFolder folder;
  write_scene(folder, four_points);
  const Result jobs = run(folder.path, {"sweep", "bar.toml", "--jobs", "2", "--no-images", "--error-every", "2"});
  ASSERT_EQ(jobs.status, 0) << jobs.err;
  const std::string all = test::read_file(folder.path / "out" / "bar-sweep" / "sweep.csv");
  for (const char* index : {"3", "1", "0", "2"}) {
    const Result one = run(folder.path, {"sweep", "bar.toml", "--index", index, "--no-images", "--error-every", "2",
                                         "--threads", "2", "--out", "alone"});
    ASSERT_EQ(one.status, 0) << one.err;
  }
  const Result merged = run(folder.path, {"sweep", "bar.toml", "--merge", "--out", "alone"});
  ASSERT_EQ(merged.status, 0) << merged.err;
  EXPECT_EQ(test::read_file(folder.path / "alone" / "sweep.csv"), all);
  const auto table = table_of(folder);
  ASSERT_EQ(table.size(), 5u);
  EXPECT_EQ(table[0][0], "point");
  EXPECT_EQ(table[1][0], "0");
  EXPECT_EQ(table[4][1], "100000");
  for (const char* name :
       {"bar.stretch", "bar.jiggle", "bar.inverted", "bar.iterations", "bar.trials", "bar.objective_end [J]",
        "bar.error_mean", "bar.error_max", "bar.motion_error_mean", "bar.motion_error_max"}) {
    EXPECT_FALSE(table[4][column(table, name)].empty()) << name;
  }
  std::set<std::string> hashes;
  for (std::size_t row = 1; row < table.size(); ++row) hashes.insert(table[row][column(table, "state_hash")]);
  EXPECT_EQ(hashes.size(), 4u);
}

TEST(SweepVerb, APointIsWhatRenderMakesOfItsValues) {
  const test::TemporaryFolder folder;
  write_scene(folder, four_points);
  ASSERT_EQ(run(folder.path, {"sweep", "bar.toml", "--index", "2", "--no-images"}).status, 0);
  const Result film = run(folder.path, {"render", "bar.toml", "--no-images", "--set", "body.bar.material.young=1e5",
                                        "--set", "body.bar.material.poisson=0"});
  ASSERT_EQ(film.status, 0) << film.err;
  EXPECT_NE(film.err.find("note: the scene has a sweep of 4 points"), std::string::npos) << film.err;
  const auto point = test::profile_of(folder.path / "out" / "bar-sweep" / "points" / "0002");
  EXPECT_EQ(point["frames"][3]["state_hash"], test::profile_of(folder.path / "out" / "bar")["frames"][3]["state_hash"]);
}

TEST(SweepVerb, DrawsTheLastFrameOfEveryPointForItsSheet) {
  const test::TemporaryFolder folder;
  write_scene(folder, four_points);
  const Result result = run(folder.path, {"sweep", "bar.toml"});
  ASSERT_EQ(result.status, 0) << result.err;
  const std::filesystem::path out = folder.path / "out" / "bar-sweep";
  EXPECT_EQ(read_png(out / "points" / "0003" / "frames" / "000003.png").width, 128);
  EXPECT_FALSE(std::filesystem::exists(out / "points" / "0003" / "frames" / "000002.png"));
  EXPECT_FALSE(std::filesystem::exists(out / "points" / "0003" / "video.mp4"));
  const auto profile = test::profile_of(out / "points" / "0003");
  EXPECT_FALSE(profile["frames"][2].contains("render_ms"));
  EXPECT_TRUE(profile["frames"][3].contains("render_ms"));
  const PngImage sheet = read_png(out / "contact-sheet.png");
  EXPECT_GT(sheet.width, 2 * 128);
  EXPECT_LT(sheet.width, 3 * 128);  // the two Poisson's ratios side by side
  const std::string page = test::read_file(out / "index.html");
  EXPECT_NE(page.find("src=\"data:image/png;base64,iVBORw0KGgo"), std::string::npos);
  EXPECT_NE(page.find("body.bar.material.poisson"), std::string::npos);
  EXPECT_EQ(read_csv(out / "times.csv").size(), 5u);
}

TEST(SweepVerb, RunsOnlyWhatIsNotDone) {
  const test::TemporaryFolder folder;
  write_scene(folder, four_points);
  ASSERT_EQ(run(folder.path, {"sweep", "bar.toml", "--index", "1", "--no-images"}).status, 0);
  const auto made = [&](const char* point) {
    return std::filesystem::last_write_time(folder.path / "out" / "bar-sweep" / "points" / point / "profile.json");
  };
  const auto first = made("0001");
  const Result partly = run(folder.path, {"sweep", "bar.toml", "--merge"});
  EXPECT_EQ(partly.status, 1);
  EXPECT_NE(partly.err.find("point 0: not run\n"), std::string::npos) << partly.err;
  EXPECT_NE(partly.err.find("3 of 4 points are not done"), std::string::npos) << partly.err;
  const Result rest = run(folder.path, {"sweep", "bar.toml", "--no-images"});
  EXPECT_EQ(rest.status, 0) << rest.err;
  EXPECT_NE(rest.err.find("1 of 4 points are done\n3 points to run"), std::string::npos) << rest.err;
  EXPECT_EQ(made("0001"), first);
  EXPECT_EQ(run(folder.path, {"sweep", "bar.toml", "--no-images", "--again"}).status, 0);
  EXPECT_NE(made("0001"), first);

  // Another scene makes the existing points outdated.
  std::ofstream(folder.path / "bar.toml") << "fps = 24\n" << bar_scene << four_points;
  const Result outdated = run(folder.path, {"sweep", "bar.toml", "--merge"});
  EXPECT_EQ(outdated.status, 1);
  EXPECT_NE(outdated.err.find("point 3: outdated (exit status 0): was made from another scene or other settings"),
            std::string::npos)
      << outdated.err;
  EXPECT_NE(run(folder.path, {"sweep", "bar.toml", "--no-images"}).err.find("4 points to run"), std::string::npos);
}

constexpr const char* tetrahedron = R"(MeshVersionFormatted 2
Dimension 3
Vertices
4
0 0 0 0
1 0 0 0
0 1 0 0
0 0 1 0
Tetrahedra
1
1 2 3 4 0
End
)";

TEST(SweepVerb, ReportsAPointThatFailsAndRepeatsItAlone) {
  const test::TemporaryFolder folder;
  std::ofstream(folder.path / "bar.toml")
      << "frames = 3\n[[body]]\nname = \"bar\"\nbox = { extent = [1, 1, 1] }\nmaterial = \"rubber\"\n"
         "[sweep.values]\n\"body.bar.mesh\" = [\"good.mesh\", \"bad.mesh\", \"good.mesh\"]\n";
  std::ofstream(folder.path / "good.mesh") << tetrahedron;
  std::ofstream(folder.path / "bad.mesh") << "not a mesh\n";
  const Result result = run(folder.path, {"sweep", "bar.toml", "--no-images", "--jobs", "1"});
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.err.find("point 1: failed (exit status 2): bad.mesh"), std::string::npos) << result.err;
  EXPECT_NE(result.err.find("1 of 3 points are not done; --index N repeats one"), std::string::npos) << result.err;
  auto table = table_of(folder);
  EXPECT_EQ(table[1][column(table, "outcome")], "done");
  EXPECT_EQ(table[2][column(table, "outcome")], "failed");
  EXPECT_EQ(table[2][column(table, "exit_status")], "2");
  EXPECT_TRUE(table[2][column(table, "message")].starts_with("bad.mesh"));
  EXPECT_EQ(table[2][column(table, "bar.stretch")], "");
  EXPECT_EQ(table[3][column(table, "outcome")], "done");

  std::ofstream(folder.path / "bad.mesh") << tetrahedron;
  EXPECT_EQ(run(folder.path, {"sweep", "bar.toml", "--no-images", "--index", "1"}).status, 0);
  EXPECT_EQ(run(folder.path, {"sweep", "bar.toml", "--merge"}).status, 0);
  table = table_of(folder);
  EXPECT_EQ(table[2][column(table, "outcome")], "done");
  EXPECT_EQ(table[2][column(table, "state_hash")], table[1][column(table, "state_hash")]);
}

TEST(SweepVerb, KeepsHowAPointEndedThatDiedWithoutAWord) {
  const test::TemporaryFolder folder;
  write_scene(folder, "[sweep.values]\n\"body.bar.box.cells\" = [[20, 10, 10], [2, 1, 1]]\n");
  rlimit usual{};
  getrlimit(RLIMIT_FSIZE, &usual);
  const rlimit small{60000, usual.rlim_max};  // the first point's motion is larger: SIGXFSZ
  setrlimit(RLIMIT_FSIZE, &small);
  const Result result = run(folder.path, {"sweep", "bar.toml", "--no-images", "--jobs", "2"});
  setrlimit(RLIMIT_FSIZE, &usual);
  EXPECT_EQ(result.status, 1);
  EXPECT_NE(result.err.find(
                fmt::format("point 0: failed (exit status {}): was ended by signal {}\n", 128 + SIGXFSZ, SIGXFSZ)),
            std::string::npos)
      << result.err;
  const auto table = table_of(folder);
  EXPECT_EQ(table[1][column(table, "outcome")], "failed");
  EXPECT_EQ(table[2][column(table, "outcome")], "done");
  EXPECT_EQ(run(folder.path, {"sweep", "bar.toml", "--no-images"}).status, 0);
}

TEST(SweepVerb, AnInterruptLeavesWhatIsDoneAndTheSameCommandGoesOn) {
  const test::TemporaryFolder folder;
  std::string values = "[sweep.values]\n\"body.bar.material.young\" = [1e4";
  for (int i = 1; i < 60; ++i) values += fmt::format(", {}e4", i + 1);
  write_scene(folder, values + "]\n");
  const std::vector<std::string> command = {"sweep", "bar.toml", "--no-images", "--frames", "60", "--jobs", "2"};
  const std::filesystem::path points = folder.path / "out" / "bar-sweep" / "points";
  const Result broken_off = run(folder.path, command, points / "0003" / "profile.json");
  EXPECT_EQ(broken_off.status, 130) << broken_off.err;
  EXPECT_NE(broken_off.err.find("The same command goes on"), std::string::npos) << broken_off.err;
  const auto first = std::filesystem::last_write_time(points / "0000" / "profile.json");
  EXPECT_FALSE(std::filesystem::exists(points / "0059"));
  const Result on = run(folder.path, command);
  EXPECT_EQ(on.status, 0) << on.err;
  EXPECT_EQ(std::filesystem::last_write_time(points / "0000" / "profile.json"), first);
  EXPECT_TRUE(std::filesystem::exists(points / "0059" / "profile.json"));
}

TEST(SweepVerb, AKilledSweepLeavesNoPointRunning) {
  const test::TemporaryFolder folder;
  write_scene(folder, four_points);
  const std::filesystem::path point = folder.path / "out" / "bar-sweep" / "points" / "0000";
  const Result killed = run(folder.path, {"sweep", "bar.toml", "--no-images", "--frames", "100000", "--jobs", "1"},
                            point / "motion" / "bar.pc2", SIGKILL);
  EXPECT_EQ(killed.status, -SIGKILL) << killed.err;
  for (int tries = 0; tries < 500 && !std::filesystem::exists(point / "point.json"); ++tries)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  const auto record = nlohmann::json::parse(test::read_file(point / "point.json"), nullptr, false);
  ASSERT_TRUE(record.is_object()) << "the point still runs";
  EXPECT_EQ(record["exit_status"], 130);
}

TEST(SweepVerb, LeavesAFolderAloneThatIsNotItsOwn) {
  const test::TemporaryFolder folder;
  write_scene(folder, four_points);
  const auto refusal = [&](const std::string& out, const std::vector<std::string>& more = {}) {
    std::vector<std::string> words = {"sweep", "bar.toml", "--no-images", "--quiet", "--frames", "1", "--out", out};
    words.insert(words.end(), more.begin(), more.end());
    const Result result = run(folder.path, words);
    EXPECT_EQ(result.status, result.err.empty() ? 0 : 2) << result.err;
    return result.err;
  };
  std::ofstream(folder.path / "file") << "mine";
  EXPECT_EQ(refusal("file"), "--out file: exists and is not a folder\n");
  for (const char* name : {"index.html", "sweep.csv", "run.json"}) {
    std::filesystem::remove_all(folder.path / "mine");
    std::filesystem::create_directory(folder.path / "mine");
    std::ofstream(folder.path / "mine" / name) << "mine";
    for (const std::vector<std::string>& what : {std::vector<std::string>{}, {"--merge"}, {"--index", "1"}})
      EXPECT_EQ(refusal("mine", what),
                "--out mine: holds files that no sweep left there; choose another folder or empty it\n");
    EXPECT_EQ(test::read_file(folder.path / "mine" / name), "mine");
  }

  EXPECT_EQ(run(folder.path, {"sweep", "bar.toml", "--merge", "--out", "four"}).status, 1);
  ASSERT_EQ(refusal("four"), "") << "a table of nothing is a sweep's";
  write_scene(folder, "[sweep.values]\n\"body.bar.density\" = [900, 1000, 1100, 1200]\n");
  EXPECT_EQ(
      refusal("four"),
      "--out four: holds another sweep: the paths are [\"body.bar.material.young\","
      "\"body.bar.material.poisson\"] there and [\"body.bar.density\"] here; choose another folder or empty it\n");
  write_scene(folder, "[sweep.values]\n\"body.bar.material.young\" = [1e4]\n\"body.bar.material.poisson\" = [0.0]\n");
  EXPECT_NE(refusal("four").find(", and the last one here is 0; choose another"), std::string::npos);
  write_scene(folder, four_points);
  EXPECT_EQ(refusal("four", {"--set", "body.bar.density=900"}), "") << "its points are outdated, and made anew";
  std::filesystem::rename(folder.path / "bar.toml", folder.path / "beam.toml");
  EXPECT_EQ(run(folder.path, {"sweep", "beam.toml", "--out", "four"}).err,
            "--out four: holds another sweep: the scene is \"bar\" there and \"beam\" here; choose another folder or "
            "empty it\n");
}

TEST(SweepVerb, CheckReadsTheSceneOfEveryPoint) {
  const test::TemporaryFolder folder;
  write_scene(folder, four_points);
  const Result good = run(folder.path, {"check", "bar.toml"});
  EXPECT_EQ(good.status, 0) << good.err;
  EXPECT_NE(good.out.find("sweep: 4 points, all readable\n"), std::string::npos) << good.out;
  write_scene(folder, "[sweep.values]\n\"body.bar.material.poisson\" = [0.3, 0.5]\n");
  const Result bad = run(folder.path, {"check", "bar.toml"});
  EXPECT_EQ(bad.status, 2);
  EXPECT_TRUE(bad.err.starts_with("bar.toml:14:37: ")) << bad.err;
  const Result sweep = run(folder.path, {"sweep", "bar.toml"});
  EXPECT_EQ(sweep.status, 2);
  EXPECT_EQ(sweep.err, bad.err);
  EXPECT_FALSE(std::filesystem::exists(folder.path / "out"));
}

TEST(ContactSheet, ShowsPicturesInOrderAndSaysWhatIsMissing) {
  const test::TemporaryFolder folder;
  const std::vector<std::uint8_t> black(300 * 200 * 3, 0);
  write_png(folder.path / "dark.png", 300, 200, black);
  Sheet sheet{"", {}, 2, {}};
  sheet.pictures = {{folder.path / "dark.png"}, {"", "failed"}, {folder.path / "dark.png"}};
  const PngImage image = compose(sheet);
  std::size_t dark = 0, grey = 0;
  for (std::size_t i = 0; i < image.rgb.size(); i += 3) {
    dark += image.rgb[i] == 0;
    grey += image.rgb[i] == 238;
  }
  EXPECT_EQ(dark, 2u * 300 * 200);
  EXPECT_EQ(grey, 1u * 300 * 200);
  write_png(folder.path / "wide.png", 2000, 500, std::vector<std::uint8_t>(2000 * 500 * 3, 0));
  sheet.pictures = {{folder.path / "wide.png"}};
  EXPECT_EQ(compose(sheet).height - 2 * 40, 460 / 4 + 8) << "a larger picture is made smaller, in its shape";
}

TEST(ContactSheet, ShowsTheValueAloneWhereItsNameDoesNotFit) {
  if (text_font().empty()) GTEST_SKIP() << "no font for captions here";
  const test::TemporaryFolder folder;
  write_png(folder.path / "a.png", 200, 100, std::vector<std::uint8_t>(200 * 100 * 3, 0));
  const auto sheet_with = [&](const std::string& words) {
    return compose({"", {{folder.path / "a.png", "", {words}}}, 1, text_font()}).rgb;
  };
  const auto value = sheet_with("[0, -9, 0]");
  EXPECT_EQ(sheet_with("a_name_that_leaves_no_room = [0, -9, 0]"), value);
  EXPECT_NE(sheet_with("g = [0, -9, 0]"), value);
}

}  // namespace sweep_verb_test
}  // namespace supple
