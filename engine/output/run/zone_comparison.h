// Compares two profiles of one run, zone by zone, by the zones' names: which became slower or faster, and whether the
// change exceeds the noise. The test is a permutation test with the largest statistic of all zones (Westfall and Young
// 1993, "Resampling-based multiple testing"); docs/profiling.md explains it in words.
#pragma once

#include <string>
#include <vector>

#include "output/run/zones.h"

namespace supple {

// A zone is named in the result only if it changed by at least this much. A smaller change means nothing, because
// memory lies elsewhere in every run and other programs use the memory bus. The zone must also have changed this much
// relative to the rest of the frame: a machine that is slower for minutes slows all zones, and those that wait for
// memory up to a tenth more than others.
constexpr double least_change = 0.1;
// A zone is tested only if it takes at least this share of the frame, and named only if it changed the frame by at
// least this share.
constexpr double least_share = 0.01;
constexpr double significance = 0.05;  // chance that any zone is named although the profiles are equal
// With fewer repeats no result can be significant: 4 and 4 can be regrouped in 70 ways.
constexpr int least_repeats_compared = 4;

struct ZoneChange {
  std::string thread, name;
  double before_ms = 0, after_ms = 0;  // time for a frame
  double change = 0;                   // after over before, less 1
  double against_rest = 0;             // ratio after/before over that of the rest of the frame, less 1; 0 for the frame
  double noise = 0;                    // 95 % of the regroupings stay below this
  double chance = 1;                   // share of regroupings in which any zone changes as clearly
  bool named = false;
};

struct ZoneComparison {
  ZoneChange frame;                                  // the whole frame, with all that lies in it
  std::vector<ZoneChange> zones;                     // by name, without what lies in them; those that are large enough
  std::vector<std::string> only_before, only_after;  // zones of that size that the other profile lacks
  // This is true when the frame changed beyond the noise and no zone changed more than the others: the cause is then
  // the build or the machine.
  bool as_a_whole = false;
  int regroupings = 0;
  bool same_bits = true;  // both end in the same state
};

// Lists, as sentences that name both values, where two profiles differ in what they must have in common; empty when
// they can be compared.
std::vector<std::string> differences(const ProfiledRun& before, const ProfiledRun& after);

// Expects profiles without differences() and with at least least_repeats_compared repeats each.
ZoneComparison compare_zones(const ZoneProfile& before, const ZoneProfile& after);

// Explains the comparison to people, with the test in words.
std::string comparison_text(const ZoneComparison& comparison);
std::string comparison_json(const ZoneComparison& comparison);

}  // namespace supple
