// Tests the comparison of profiles that are generated with the noise of a shared machine.
#include "output/run/zone_comparison.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <random>

namespace supple {
namespace zone_comparison_test {

constexpr int frames = 60, repeats = 5;

struct Machine {
  std::mt19937_64 random;
  double uniform(double low, double high) { return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53; }

  // Turns an exact time into what a shared machine measures: a few per cent slower for as long as a repeat lasts,
  // always with a little jitter, and with an interruption now and then.
  double measured(double ms, double slow_spell) {
    double noisy = ms * slow_spell * (1 - 0.015 * std::log(uniform(1e-9, 1)));
    if (uniform(0, 1) < 0.04) noisy += uniform(0, 0.5);
    return noisy;
  }
};

struct Leaf {
  const char *path, *name;
  double ms;
};
const std::vector<Leaf> leaves = {
    {"frame/step/evaluate", "evaluate", 2.5},    {"frame/step/solve", "solve", 1.2},
    {"frame/step/L-BFGS", "L-BFGS", 0.7},        {"frame/step/find contacts", "find contacts", 0.3},
    {"frame/measure", "measure", 0.5},           {"frame/hash", "hash", 0.08},
    {"frame/motion files", "motion files", 0.02}};

// slowed: the zone that takes `factor` times as long.
ZoneProfile made_profile(unsigned seed, const std::string& slowed = "", double factor = 1, double pace = 1) {
  Machine machine{std::mt19937_64(seed)};
  const double speed = pace * machine.uniform(0.985, 1.015);  // the machine's speed during the whole run
  ZoneProfile profile;
  profile.run.scene = "made";
  profile.run.scene_json = R"({"frames":60,"body":[{"material":{"mu":1}}]})";
  profile.run.frames = frames;
  profile.run.fps = 30;
  const ZoneTimes empty{"main", "frame", 1, {}, {}};
  profile.zones.push_back(empty);
  for (const Leaf& leaf : leaves) profile.zones.push_back({"main", leaf.path, 1, {}, {}});
  for (int repeat = 0; repeat < repeats; ++repeat) {
    const double spell = speed * machine.uniform(1, 1.06);
    ++profile.repeats;
    for (ZoneTimes& zone : profile.zones) zone.ms.emplace_back(frames, 0.0);
    for (int frame = 0; frame < frames; ++frame) {
      for (std::size_t z = 0; z < leaves.size(); ++z) {
        const double work = leaves[z].ms * (1 + 0.3 * std::sin(0.2 * frame + static_cast<double>(z)));
        const double clean = leaves[z].path == slowed ? factor * work : work;
        const double ms = machine.measured(frame == 0 ? 10 * clean : clean, spell);
        profile.zones[z + 1].ms[repeat][frame] = ms;
        profile.zones[0].ms[repeat][frame] += ms;
      }
    }
  }
  for (ZoneTimes& zone : profile.zones) zone.self_ms = zone.ms;
  for (auto& self : profile.zones[0].self_ms) self.assign(frames, 0.0);
  return profile;
}

std::vector<std::string> named(const ZoneComparison& comparison) {
  std::vector<std::string> names;
  if (comparison.frame.named) names.push_back("frame");
  for (const ZoneChange& zone : comparison.zones) {
    if (zone.named) names.push_back(zone.name);
  }
  return names;
}

TEST(ZoneComparison, NamesNothingBetweenEqualProfiles) {
  for (unsigned pair = 0; pair < 20; ++pair) {
    const ZoneComparison result = compare_zones(made_profile(2 * pair), made_profile(2 * pair + 1));
    EXPECT_EQ(named(result), std::vector<std::string>{}) << "pair " << pair << "\n" << comparison_text(result);
    EXPECT_EQ(result.regroupings, 252);
  }
}

TEST(ZoneComparison, NamesAZoneThatTakesAFifthMoreAndNoOtherZone) {
  for (unsigned pair = 0; pair < 20; ++pair) {
    const Leaf& slowed = leaves[pair % 5];
    const ZoneComparison result = compare_zones(made_profile(2 * pair), made_profile(2 * pair + 1, slowed.path, 1.2));
    bool found = false;
    for (const ZoneChange& zone : result.zones) {
      EXPECT_EQ(zone.named, zone.name == slowed.name) << "pair " << pair << "\n" << comparison_text(result);
      if (zone.name != slowed.name) continue;
      found = true;
      EXPECT_NEAR(zone.change, 0.2, 0.06);
      EXPECT_LE(zone.chance, significance);
    }
    EXPECT_TRUE(found);
    EXPECT_NE(comparison_text(result).find("  slower"), std::string::npos);
  }
}

TEST(ZoneComparison, TellsAZoneFromASlowMachine) {
  for (unsigned pair = 0; pair < 20; ++pair) {
    const ZoneComparison slow = compare_zones(made_profile(2 * pair), made_profile(2 * pair + 1, "", 1, 1.25));
    EXPECT_TRUE(slow.as_a_whole);
    EXPECT_EQ(named(slow), std::vector<std::string>{}) << "pair " << pair << "\n" << comparison_text(slow);
    EXPECT_NE(comparison_text(slow).find("the build, or the state of the machine"), std::string::npos);
    const Leaf& slowed = leaves[pair % 5];
    const ZoneComparison both =
        compare_zones(made_profile(2 * pair), made_profile(2 * pair + 1, slowed.path, 1.2, 1.25));
    EXPECT_EQ(named(both), (std::vector<std::string>{"frame", slowed.name})) << comparison_text(both);
  }
}

TEST(ZoneComparison, NamesWhatBecameFasterAndTheFrameWithIt) {
  const ZoneComparison result = compare_zones(made_profile(1), made_profile(2, "frame/step/evaluate", 0.7));
  EXPECT_EQ(named(result), (std::vector<std::string>{"frame", "evaluate"}));
  EXPECT_NE(comparison_text(result).find("  faster"), std::string::npos);
  const auto json = nlohmann::json::parse(comparison_json(result));
  EXPECT_TRUE(json["frame"]["named"]);
  EXPECT_LT(json["zones"][0]["change"], -0.2);
}

TEST(ZoneComparison, LeavesSmallZonesAndWaitingAloneAndTellsOfZonesThatCameOrWent) {
  ZoneProfile before = made_profile(1), after = made_profile(2, "frame/motion files", 1.5);
  for (const ZoneChange& zone : compare_zones(before, after).zones) EXPECT_NE(zone.name, "motion files");
  before.zones.push_back({"main", "frame/wait for render", 1, before.zones[1].ms, before.zones[1].ms});
  after.zones[2].path = "frame/step/inverse";
  const ZoneComparison result = compare_zones(before, after);
  EXPECT_EQ(result.only_before, std::vector<std::string>{"solve"});
  EXPECT_EQ(result.only_after, std::vector<std::string>{"inverse"});
  EXPECT_EQ(named(result), std::vector<std::string>{});
}

TEST(ZoneComparison, CountsWaitingForWorkersToWhoAskedForTheirWork) {
  const ZoneProfile before = made_profile(1);
  ZoneProfile after = made_profile(2);
  ZoneTimes waiting = after.zones[1], worker = waiting;
  waiting.path = "frame/step/evaluate/wait for workers";
  for (auto& repeat : waiting.self_ms) {
    for (double& ms : repeat) ms *= 0.5;
  }
  after.zones[1].self_ms = waiting.self_ms;
  worker.thread = "worker";
  worker.path = "evaluate";
  after.zones.insert(after.zones.end(), {waiting, worker});
  const ZoneComparison result = compare_zones(before, after);
  EXPECT_EQ(named(result), std::vector<std::string>{}) << comparison_text(result);
  EXPECT_TRUE(result.only_after.empty());
}

TEST(ZoneComparison, SaysWhatKeepsTwoRunsFromBeingCompared) {
  const ProfiledRun run = made_profile(1).run;
  EXPECT_TRUE(differences(run, run).empty());
  ProfiledRun other = run;
  other.version = "another";
  other.state_hash = "another";
  EXPECT_TRUE(differences(run, other).empty());
  other.frames = 61;
  EXPECT_EQ(differences(run, other), std::vector<std::string>{"the numbers of frames differ: 60 and 61"});
  other.frames = 60;
  other.threads = 2;
  other.pictures = "llvmpipe";
  EXPECT_EQ(differences(run, other), (std::vector<std::string>{"the numbers of threads differ: 1 and 2",
                                                               "the pictures differ: none and llvmpipe"}));
  other = run;
  other.scene_json = R"({"frames":60,"body":[{"material":{"mu":2}}]})";
  EXPECT_EQ(differences(run, other), std::vector<std::string>{"the scenes differ at /body/0/material/mu: 1 and 2"});
  other.scene_json = R"({"frames":60,"body":[{"material":{"mu":1,"lambda":3}}]})";
  EXPECT_EQ(differences(run, other),
            std::vector<std::string>{"the scenes differ at /body/0/material/lambda: absent and 3"});
}

}  // namespace zone_comparison_test
}  // namespace supple
