// Tests traces written for other programs, and zones summed from them.
#include "output/run/zones.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "output/files/whole_file.h"
#include "output/pages/zone_table.h"
#include "output/run/chrome_trace.h"
#include "support/bodies.h"

namespace supple {
namespace zones_test {

TraceEvent event(const char* name, int depth, double begin_ms, double end_ms, int number = -1) {
  const auto ns = [](double ms) { return 1000000000 + std::int64_t(ms * 1e6); };
  return {name, ns(begin_ms), ns(end_ms), depth, number, {}};
}

// Makes two frames of 10 ms and one of 20 ms; the second step is interrupted by waiting.
std::vector<ThreadTrace> small_trace() {
  ThreadTrace main{"main", 0, {}, 0};
  main.events = {event("read scene", 0, 0, 5), event("frame", 0, 10, 20, 0), event("step", 1, 11, 18),
                 event("solve", 2, 12, 15),    event("hash", 1, 18, 19),     event("frame", 0, 20, 30, 1),
                 event("step", 1, 20, 29),     event("solve", 2, 21, 22),    event("solve", 2, 22, 25),
                 event("frame", 0, 30, 50, 2), event("step", 1, 30, 50),     event("solve", 2, 40, 50),
                 event("draw list", 1, 50, 50)};
  ThreadTrace render{"render", 0, {}, 0};
  render.events = {event("start renderer", 0, 6, 9), event("render", 0, 21, 41, 0), event("render", 0, 41, 51, 1)};
  ThreadTrace one{"worker", 1, {event("solve", 0, 1, 2), event("solve", 0, 12, 14)}, 0};
  ThreadTrace two{"worker", 2, {event("solve", 0, 12, 13), event("solve", 0, 45, 46)}, 0};
  return {main, render, one, two};
}

ZoneProfile small_profile(int repeats = 1) {
  ProfiledRun run;
  run.scene = "small";
  run.scene_json = R"({"frames":3})";
  run.frames = 3;
  run.fps = 60;
  run.meshes = {{"soft", "00ff"}};
  ZoneCollector collector(run);
  for (int i = 0; i < repeats; ++i) collector.add(small_trace());
  return collector.result();
}

const ZoneTimes& zone(const ZoneProfile& profile, const std::string& thread, const std::string& path) {
  for (const ZoneTimes& row : profile.zones) {
    if (row.thread == thread && row.path == path) return row;
  }
  throw std::runtime_error("no zone " + path);
}

using Frames = std::vector<double>;

void expect_times(const Frames& times, const Frames& expected) {
  ASSERT_EQ(times.size(), expected.size());
  for (std::size_t i = 0; i < times.size(); ++i) EXPECT_NEAR(times[i], expected[i], 1e-9) << i;
}

TEST(Zones, AddUpByFrameUnderAllThatTheyLieIn) {
  const ZoneProfile profile = small_profile(2);
  EXPECT_EQ(profile.repeats, 2);
  EXPECT_EQ(profile.zones.front().path, "frame");
  expect_times(profile.zones.front().ms[1], {10, 10, 20});
  expect_times(zone(profile, "main", "frame/step").ms[0], {7, 9, 20});
  expect_times(zone(profile, "main", "frame/step").self_ms[0], {4, 5, 10});
  expect_times(zone(profile, "main", "frame/step/solve").ms[0], {3, 4, 10});
  expect_times(zone(profile, "main", "frame/hash").ms[0], {1, 0, 0});
  expect_times(zone(profile, "main", "frame/draw list").ms[0], {0, 0, 0});  // beside the step, not in it
  EXPECT_DOUBLE_EQ(zone(profile, "main", "frame/step/solve").calls, 4.0 / 3);
  // Zones of other threads count to the frame that they name, or else to the one that is being made at the time.
  expect_times(zone(profile, "render", "render").ms[0], {20, 10, 0});
  expect_times(zone(profile, "worker", "solve").ms[0], {3, 0, 1});
  ASSERT_EQ(profile.setup.size(), 2u);
  EXPECT_EQ(profile.setup[0].name, "read scene");
  expect_times(profile.setup[0].ms, {5, 5});
  EXPECT_EQ(profile.setup[1].name, "start renderer");
}

TEST(Zones, TimesWithoutTheZonesWithinAddUpToTheFrames) {
  const ZoneProfile profile = small_profile();
  for (int frame = 0; frame < 3; ++frame) {
    double sum = 0;
    for (const ZoneTimes& row : profile.zones) {
      if (row.thread == "main") sum += row.self_ms[0][frame];
    }
    EXPECT_NEAR(sum, profile.zones.front().ms[0][frame], 1e-9);
  }
}

TEST(Zones, RepeatsOfSeveralProcessesAddUp) {
  ZoneProfile profile = small_profile(1);
  add_repeats(small_profile(2), profile);
  EXPECT_EQ(zones_json(profile), zones_json(small_profile(3)));
  ZoneProfile shorter = small_profile(1);  // a repeat in which nothing was solved within a step
  std::erase_if(shorter.zones, [](const ZoneTimes& z) { return z.path == "frame/step/solve"; });
  add_repeats(small_profile(1), shorter);
  const ZoneTimes& solve = zone(shorter, "main", "frame/step/solve");
  EXPECT_EQ(solve.ms.size(), 2u);
  EXPECT_EQ(solve.ms[0], std::vector<double>(3, 0.0));
  EXPECT_EQ(solve.ms[1], zone(small_profile(1), "main", "frame/step/solve").ms[0]);
  const auto place = [&](const std::string& path) {
    return std::find_if(shorter.zones.begin(), shorter.zones.end(), [&](const ZoneTimes& z) { return z.path == path; });
  };
  EXPECT_LT(place("frame/step"), place("frame/step/solve"));
  EXPECT_LT(place("frame/step/solve"), place("frame/hash"));
}

TEST(Zones, ComeBackFromTheirFile) {
  const test::TemporaryFolder folder;
  const std::filesystem::path path = folder.path / "zones.json";
  const std::string text = zones_json(small_profile(2));
  write_whole_file(path, text);
  EXPECT_EQ(zones_json(read_zones(path)), text);
  EXPECT_THROW(read_zones(folder.path / "none.json"), InputError);
  for (const std::string& wrong : {std::string("{}"), text.substr(0, text.size() / 2), std::string("[1, 2]")}) {
    write_whole_file(path, wrong);
    EXPECT_THROW(read_zones(path), InputError) << wrong.substr(0, 20);
  }
  std::string shorter = text;
  shorter.replace(shorter.find("[10.0,10.0,20.0]"), 16, "[10.0,10.0]");
  write_whole_file(path, shorter);
  EXPECT_THROW(read_zones(path), InputError);
}

TEST(Zones, TableCountsMissedDeadlinesAndNamesSlowFrames) {
  const ZoneProfile profile = small_profile(3);
  const Deadline deadline = deadline_of(profile);
  EXPECT_EQ(deadline.frames, 6);     // the first frame of each repeat is left out
  EXPECT_EQ(deadline.late_wall, 3);  // those of 20 ms
  EXPECT_EQ(deadline.late_work, 6);  // those of 9 + 10 ms and of 20 ms
  const std::vector<SlowFrame> slow = slow_frames(profile, 1);
  ASSERT_EQ(slow.size(), 1u);
  EXPECT_EQ(slow[0].frame, 2);
  EXPECT_EQ(slow[0].zone, "step/solve");
  EXPECT_NEAR(slow[0].excess_ms, 6, 1e-9);
  double share = 0;
  for (const ZoneSummary& row : summarize(profile)) {
    if (row.thread == "main") share += row.self_share;
  }
  EXPECT_NEAR(share, 1, 1e-12);
  const std::string table = zone_table(profile);
  for (const char* word : {"\n  frame ", "\n    step ", "\n      solve ", "outside zones", "meanwhile, render",
                           "read scene 5.0 ms", "of 6 frames 3 are late by wall time", " 6 by work", " 2 20.00 ms"})
    EXPECT_NE(table.find(word), std::string::npos) << word << "\n" << table;
  EXPECT_EQ(nlohmann::json::parse(summary_json(profile))["deadline"]["late_work"], 6);
}

// The zones that are open on each track are followed from begin to end.
TEST(ChromeTrace, IsJsonWhoseZonesNestWithinTheirTracks) {
  std::vector<ThreadTrace> threads = small_trace();
  threads[0].lost = 2;
  const std::string name = "b\"ody\xc3";  // quoted, and cut within a letter
  std::ranges::copy(name, threads[0].events[2].subject.begin());
  const auto json = nlohmann::json::parse(chrome_trace(threads));
  EXPECT_EQ(json["otherData"]["lost_zones"], 2);
  std::map<int, std::string> tracks;
  std::map<int, std::vector<double>> ends;
  std::size_t zones = 0;
  for (const auto& e : json["traceEvents"]) {
    const int track = e["tid"];
    if (e["ph"] == "M") {
      if (e["name"] == "thread_name") tracks[track] = e["args"]["name"];
      continue;
    }
    ASSERT_EQ(e["ph"], "X");
    ++zones;
    const double begin = e["ts"], end = begin + e["dur"].get<double>();
    EXPECT_GE(begin, 0);
    EXPECT_LE(begin, end);
    std::vector<double>& open = ends[track];
    while (!open.empty() && open.back() <= begin) open.pop_back();
    if (!open.empty()) {
      EXPECT_LE(end, open.back()) << e;
    }
    open.push_back(end);
  }
  EXPECT_EQ(zones, 20u);
  EXPECT_EQ(tracks, (std::map<int, std::string>{{1, "main"}, {2, "render"}, {3, "worker 1"}, {4, "worker 2"}}));
  EXPECT_EQ(json["traceEvents"][3]["args"]["frame"], 0);
  EXPECT_TRUE(json["traceEvents"][4]["args"]["body"].get<std::string>().starts_with("b\"ody"));
}

}  // namespace zones_test
}  // namespace supple
