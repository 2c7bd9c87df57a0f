// Two profiles of one run, zone by zone, by their names: what became slower or faster, and whether that is beyond the
// noise. The test is a permutation test with the largest statistic of all zones (Westfall and Young 1993,
// "Resampling-based multiple testing"); docs/profiling.md tells it in words.
#pragma once

#include <string>
#include <vector>

#include "output/zones.h"

namespace supple {

// Of a zone that is named. Less says nothing: memory lies elsewhere in every run, and other programs use its bus.
// Also against the rest of the frame: a machine that is slower for minutes slows all zones, those that wait for memory
// up to a tenth more than others.
constexpr double least_change = 0.1;
// Of the frame: what zones that are tested have of it, and what those that are named changed it by.
constexpr double least_share = 0.01;
constexpr double significance = 0.05;      // chance that equal profiles have any zone named
constexpr int least_repeats_compared = 4;  // fewer cannot reach that: 4 and 4 can be regrouped in 70 ways

struct ZoneChange {
  std::string thread, name;
  double before_ms = 0, after_ms = 0;  // a frame
  double change = 0;                   // after over before, less 1
  double against_rest = 0;             // the same over that of the rest of the frame; of the frame 0
  double noise = 0;                    // what 95 % of the regroupings stay below
  double chance = 1;                   // share of regroupings in which any zone changes as clearly
  bool named = false;
};

struct ZoneComparison {
  ZoneChange frame;                                  // as a whole, with all that lies in it
  std::vector<ZoneChange> zones;                     // by name, without what lies in them; those that are large enough
  std::vector<std::string> only_before, only_after;  // zones of that size that the other profile lacks
  bool as_a_whole =
      false;  // the frame changed beyond the noise, and no zone ahead of the others: the build, or the machine
  int regroupings = 0;
  bool same_bits = true;  // both end in the same state
};

// What two profiles would have to have in common, as sentences that name both; empty when they can be compared.
std::vector<std::string> differences(const ProfiledRun& before, const ProfiledRun& after);

// Both have differences() that are empty, and least_repeats_compared.
ZoneComparison compare_zones(const ZoneProfile& before, const ZoneProfile& after);

// For people, with the test in words.
std::string comparison_text(const ZoneComparison& comparison);
std::string comparison_json(const ZoneComparison& comparison);

}  // namespace supple
