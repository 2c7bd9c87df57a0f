// The page of a run.
#include "output/pages/run_page.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>

#include "scene/definition/scene_def.h"
#include "support/bodies.h"

namespace supple {
namespace run_page_test {

// A run of two bodies, one of which touches something, with a warning and names that HTML must not take for its own.
RunRecord small_run(const std::filesystem::path& folder, int frames) {
  RunRecord run;
  run.folder = folder;
  run.info_json = R"json({"command": ["supple", "render", "<b>"], "ended": "done", "scene_file": "/x/</script>.toml",
    "scene": {"title": "A & B"}, "meshes": [{"body": "soft", "vertices": 8, "elements": 5, "source": "box"}],
    "program": {"version": "1"}, "machine": {"cpu": "one", "threads": 2}})json";
  for (int frame = 0; frame < frames; ++frame) {
    FrameRow row;
    row.frame = frame;
    row.time_s = (frame + 1) / 25.0;
    row.step_ms = frame == 3 ? 90 : 10;
    row.bodies.resize(2);
    row.bodies[0].name = "soft";
    row.bodies[1].name = "hard & <wet>";
    row.bodies[1].inverted = 3;
    row.bodies[0].error_estimate = 1e-5 * (frame + 1);
    row.bodies[1].contact.emplace();
    row.bodies[1].contact->contacts = frame;
    run.rows.push_back(row);
  }
  std::ofstream(folder / "profile.json") << R"({"summary": {"verdict": "solving is 90 % & more"}})";
  return run;
}

nlohmann::json data_of(const std::string& page) {
  const std::string head = "id=\"data\">";
  const std::size_t from = page.find(head) + head.size();
  return nlohmann::json::parse(page.substr(from, page.find("</script>", from) - from));
}

TEST(RunPage, HoldsEveryFramesValuesForItsCursor) {
  const test::TemporaryFolder folder;
  const nlohmann::json data = data_of(run_page(small_run(folder.path, 6)));
  EXPECT_EQ(data["frames"], 6);
  EXPECT_NEAR(data["rate"].get<double>(), 25, 1e-9);
  // Solving, two estimates for each body, a stretch for each, contacts and depth of one.
  ASSERT_EQ(data["series"].size(), 9u);
  EXPECT_EQ(data["series"][0], (std::vector<double>{10, 10, 10, 90, 10, 10}));
  EXPECT_EQ(data["series"][7], (std::vector<double>{0, 1, 2, 3, 4, 5}));
}

TEST(RunPage, KnowsTheRateOfAFilmThatGoesOnFromAnEarlierOne) {
  const test::TemporaryFolder folder;
  RunRecord run = small_run(folder.path, 6);
  for (FrameRow& row : run.rows) row.time_s += 2;
  EXPECT_NEAR(data_of(run_page(run))["rate"].get<double>(), 25, 1e-9);
}

TEST(RunPage, ShowsPairsOfBodiesThatTouched) {
  const test::TemporaryFolder folder;
  RunRecord run = small_run(folder.path, 3);
  run.rows[1].pairs = {{{"soft", "hard & <wet>"}, 7, 0.004, 1}};
  const std::string page = run_page(run);
  const nlohmann::json data = data_of(page);
  ASSERT_EQ(data["series"].size(), 11u);
  EXPECT_EQ(data["series"][9], (std::vector<double>{0, 7, 0}));
  EXPECT_EQ(data["series"][10], (std::vector<double>{0, 0.004, 0}));
  EXPECT_NE(page.find("soft and hard &amp; &lt;wet&gt;"), std::string::npos);
  EXPECT_NE(page.find("Deepest point inside another body"), std::string::npos);
}

TEST(RunPage, ShowsTheDeepestPairsWhereThereAreMoreThanColours) {
  const test::TemporaryFolder folder;
  RunRecord run = small_run(folder.path, 3);
  for (int pair = 0; pair < 10; ++pair)
    run.rows[1].pairs.push_back({{"soft", "ball " + std::to_string(pair)}, 1, 0.001 * (pair + 1), 0});
  const std::string page = run_page(run);
  EXPECT_EQ(data_of(page)["series"].size(), 9u + 2 * 8u);
  EXPECT_NE(page.find("(the 8 deepest pairs)"), std::string::npos);
  EXPECT_LT(page.find("soft and ball 9"), page.find("soft and ball 2"));
  EXPECT_EQ(page.find("soft and ball 1<"), std::string::npos);
  EXPECT_EQ(page.find("soft and ball 1 "), std::string::npos);
}

TEST(RunPage, SaysWhatHelpsOnlyWhereTheFilmIsSlowerThanAsked) {
  const test::TemporaryFolder folder;
  RunRecord run = small_run(folder.path, 6);
  EXPECT_EQ(run_page(run).find("solving is 90 %"), std::string::npos);
  run.rows[3].step_ms = 900;
  EXPECT_NE(run_page(run).find("solving is 90 %"), std::string::npos);
}

TEST(RunPage, ShowsTheWarningsOfTheProfile) {
  const test::TemporaryFolder folder;
  RunRecord run = small_run(folder.path, 3);
  run.rows[1].bodies[0].unsolved = true;
  EXPECT_NE(run_page(run).find("1 of 3 frames did not come near"), std::string::npos) << "a run that was killed";
  std::ofstream(run.folder / "profile.json") << R"({"summary": {"warnings": ["the film is too short & sweet"]}})";
  const std::string page = run_page(run);
  EXPECT_EQ(page.find("did not come near"), std::string::npos);
  EXPECT_NE(page.find("the film is too short &amp; sweet"), std::string::npos);
}

TEST(RunPage, TellsTheTimesThatCaptionsTell) {
  const test::TemporaryFolder folder;
  const std::string page = run_page(small_run(folder.path, 6));
  const nlohmann::json times = data_of(page)["times"];
  ASSERT_EQ(times.size(), 6u);
  SceneDef scene;
  scene.fps = 25;
  for (int frame = 0; frame < 6; ++frame) EXPECT_EQ(times[std::size_t(frame)], scene.time_after(frame)) << frame;
  EXPECT_NE(page.find("data.times[shown].toFixed(2)"), std::string::npos);
  EXPECT_NE(page.find("<div class=\"times\"><span>0.04 s</span><span>0.24 s</span></div>"), std::string::npos);
  scene.fps = 30;
  EXPECT_NEAR(scene.time_after(200), 6.7, 1e-12);  // after its steps, and not 6.67
}

TEST(RunPage, NeedsNoOtherFileAndTakesNoNameForMarkup) {
  const test::TemporaryFolder folder;
  RunRecord slow = small_run(folder.path, 6);
  slow.rows[3].step_ms = 900;
  const std::string page = run_page(slow);
  EXPECT_FALSE(std::regex_search(page, std::regex("(src|href)=\"(?!data:)"))) << "something is loaded";
  EXPECT_EQ(page.find("http"), std::string::npos);
  EXPECT_NE(page.find("<title>A &amp; B</title>"), std::string::npos);
  EXPECT_NE(page.find("solving is 90 % &amp; more"), std::string::npos);
  EXPECT_NE(page.find("class=\"warning\">body &#39;hard &amp; &lt;wet&gt;&#39; has 3 elements turned inside out"),
            std::string::npos);
  EXPECT_EQ(page.find("/x/</script>"), std::string::npos);
  EXPECT_NE(page.find("This run has no film."), std::string::npos);
  const std::size_t slowest = page.find("<tr data-frame=");
  EXPECT_EQ(page.substr(slowest, 18), "<tr data-frame=\"3\"");
  EXPECT_NE(page.find("<th>all stages [ms]</th><th>solving</th>"), std::string::npos);
}

TEST(RunPage, ShowsHowValuesDifferThatAreAllNearOne) {
  const test::TemporaryFolder folder;
  RunRecord run = small_run(folder.path, 6);
  for (FrameRow& row : run.rows) {
    row.bodies[0].stretch = 1 + 0.01 * row.frame;
    row.bodies[1].stretch = 1;
  }
  const std::string page = run_page(run);
  const std::string graph = page.substr(page.find("Largest stretch"));
  const std::string ticks = graph.substr(0, graph.find("<svg"));
  EXPECT_NE(ticks.find(">1.04<"), std::string::npos) << ticks;
  EXPECT_EQ(ticks.find(">0<"), std::string::npos) << ticks;
}

// The curve of a value that only some frames have leads over the others, and a first frame that takes long does not
// press the others to the ground.
TEST(RunPage, ShowsValuesOfSomeFramesAndLeavesTheFirstFramesTimeAside) {
  const test::TemporaryFolder folder;
  RunRecord run = small_run(folder.path, 6);
  run.rows[0].step_ms = 5000;
  for (FrameRow& row : run.rows) {
    row.bodies[0].error_measured = row.frame % 2 == 0;
    row.bodies[0].motion_estimate = 0.02;
    if (row.bodies[0].error_measured) row.bodies[0].error = row.bodies[0].motion_error = 1e-3 / (row.frame + 1);
  }
  const std::string page = run_page(run);
  const std::string times = page.substr(page.find("Time by stage"));
  EXPECT_NE(times.substr(0, times.find("<svg")).find(">100<"), std::string::npos) << times;
  EXPECT_EQ(times.substr(0, times.find("<svg")).find("000<"), std::string::npos) << times;
  for (const char* title : {"Error of a step", "Error of motion"}) {
    ASSERT_NE(page.find(title), std::string::npos) << title;
    const std::string errors = page.substr(page.find(title));
    const std::size_t measured = errors.find("<path", errors.find("<path", errors.find("<path") + 1) + 1);
    const std::string curve = errors.substr(measured, errors.find("/>", measured) - measured);
    EXPECT_EQ(std::ranges::count(curve, 'M'), 1) << curve;
    EXPECT_EQ(std::ranges::count(curve, 'L'), 2) << curve;
  }
}

TEST(RunPage, HasNoColumnWithoutAValue) {
  const test::TemporaryFolder folder;
  const std::string page = run_page(small_run(folder.path, 6));
  EXPECT_EQ(page.find("<th>drawing</th>"), std::string::npos);
  EXPECT_NE(page.find("<th>of it contacts</th>"), std::string::npos);
}

TEST(RunPage, TellsWhatWasRunBeforeThereAreFrames) {
  const test::TemporaryFolder folder;
  const std::string page = run_page(small_run(folder.path, 0));
  EXPECT_NE(page.find("What was run"), std::string::npos);
  EXPECT_EQ(page.find("class=\"area\""), std::string::npos);
}

}  // namespace run_page_test
}  // namespace supple
