// Tests the line that names the most expensive stage of a frame.
#include "output/run/verdict.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace supple {
namespace verdict_test {

TEST(Verdict, NamesTheDearestStageAndWhatHelps) {
  EXPECT_EQ(
      verdict({12.06, 43, 4, 1.5}),
      "drawing is 71 % of the work for a frame (solving 12.1 ms, drawing 43.0 ms, compressing 4.0 ms, encoding 1.5 "
      "ms): fewer samples, a smaller size or --no-images help");
  EXPECT_EQ(verdict({20, 0, 0, 0}),
            "solving is 100 % of the work for a frame (solving 20.0 ms): a coarser mesh, fewer iterations or fewer "
            "substeps help");
  EXPECT_TRUE(verdict({1, 1, 2, 1}).starts_with("compressing is 40 %"));
  EXPECT_TRUE(verdict({1, 1, 2, 4}).starts_with("encoding is 50 %"));
  EXPECT_EQ(verdict({}), "");
}

TEST(Verdict, AveragesTheFramesButTheFirst) {
  FrameRow row;
  row.step_ms = 1000;
  std::vector<FrameRow> rows(3, row);
  rows[1].step_ms = 10;
  rows[1].change_ms = 4;
  rows[2].step_ms = 20;
  rows[2].draw_ms = 1;
  rows[2].render_ms = 9;
  rows[2].compress_ms = 3;
  const FrameWork work = work_of(rows, 2.5);
  EXPECT_DOUBLE_EQ(work.solving, 17);
  EXPECT_DOUBLE_EQ(work.drawing, 5);
  EXPECT_DOUBLE_EQ(work.compressing, 1.5);
  EXPECT_DOUBLE_EQ(work.encoding, 2.5);
  EXPECT_DOUBLE_EQ(work_of({row}, 0).solving, 1000);
  EXPECT_EQ(verdict(work_of(std::vector<FrameRow>(), 0)), "");
  const auto json = nlohmann::json::parse(profile_json(rows, verdict(work)));
  EXPECT_EQ(json["summary"]["verdict"], verdict(work));
  EXPECT_FALSE(nlohmann::json::parse(profile_json(rows))["summary"].contains("verdict"));
}

TEST(Verdict, OfAProfileAveragesTheRepeatsToo) {
  ZoneProfile profile;
  profile.run.frames = 3;
  profile.repeats = 2;
  const auto add = [&profile](const char* path, std::vector<double> a, std::vector<double> b) {
    ZoneTimes zone;
    zone.path = path;
    zone.ms = {std::move(a), std::move(b)};
    profile.zones.push_back(zone);
  };
  add("frame", {99, 99, 99}, {99, 99, 99});
  add("frame/step", {99, 10, 20}, {99, 30, 40});
  add("frame/step/solve", {99, 1, 1}, {99, 1, 1});
  add("frame/draw list", {99, 1, 1}, {99, 1, 1});
  add("render", {99, 5, 5}, {99, 5, 9});
  add("compress", {99, 2, 2}, {99, 2, 2});
  const FrameWork work = work_of(profile);
  EXPECT_DOUBLE_EQ(work.solving, 25);
  EXPECT_DOUBLE_EQ(work.drawing, 7);
  EXPECT_DOUBLE_EQ(work.compressing, 2);
  EXPECT_DOUBLE_EQ(work.encoding, 0);
}

}  // namespace verdict_test
}  // namespace supple
