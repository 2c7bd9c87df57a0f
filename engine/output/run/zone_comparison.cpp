#include "output/run/zone_comparison.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>

#include "base/error.h"
#include "output/files/json_text.h"

namespace supple {
namespace {

constexpr int most_regroupings = 2000;
// The change of a zone is assumed to vary at least this much: clocks and caches are no steadier between two processes.
constexpr double least_spread = 0.002;

using Times = std::vector<std::vector<double>>;  // by repeat, then by frame
using Group = std::vector<int>;                  // places of repeats, in order

// Holds the repeats of a zone in both profiles; those of the profile `before` come first.
struct Pooled {
  ZoneChange change;
  Times ms;
};

// Takes the least time of each frame over a group of repeats, and sums it over all frames but the first, which warms
// caches. The work of a frame is the same in every repeat, so whatever exceeds the least is the machine's doing.
double least_time(const Times& ms, const Group& group) {
  double sum = 0;
  const std::size_t frames = ms.front().size();
  for (std::size_t frame = frames > 1 ? 1 : 0; frame < frames; ++frame) {
    double least = std::numeric_limits<double>::infinity();
    for (const int repeat : group) least = std::min(least, ms[repeat][frame]);
    sum += least;
  }
  return sum;
}

Group complement(const Group& group, int of) {
  Group rest;
  for (int i = 0; i < of; ++i) {
    if (!std::ranges::binary_search(group, i)) rest.push_back(i);
  }
  return rest;
}

// Lists the ways to choose `count` of `of` repeats: all of them, or a number that is enough, always the same ones. The
// first is 0, 1, ..., as the repeats were measured.
std::vector<Group> regroupings(int of, int count) {
  std::vector<Group> groups;
  Group group(count);
  for (int i = 0; i < count; ++i) group[i] = i;
  double ways = 1;
  for (int i = 0; i < count; ++i) ways *= static_cast<double>(of - i) / (i + 1);
  if (ways > most_regroupings) {
    groups.push_back(group);
    std::mt19937_64 random(1);
    while (static_cast<int>(groups.size()) < most_regroupings) {
      Group drawn;
      for (int i = 0, left = count; i < of; ++i) {
        if (random() % static_cast<unsigned>(of - i) >= static_cast<unsigned>(left)) continue;
        drawn.push_back(i);
        --left;
      }
      groups.push_back(drawn);
    }
    return groups;
  }
  for (;;) {
    groups.push_back(group);
    int i = count - 1;
    while (i >= 0 && group[i] == of - count + i) --i;
    if (i < 0) return groups;
    ++group[i];
    for (int k = i + 1; k < count; ++k) group[k] = group[k - 1] + 1;
  }
}

Times pooled(const Times& before, const Times& after) {
  Times all = before;
  all.insert(all.end(), after.begin(), after.end());
  return all;
}

// Holds one zone's own time, without the zones within it, summed over all places where the zone occurs, because a
// change to that part of the code affects all of them.
struct Part {
  std::string thread, name;
  Times ms;
};

// Returns the zone to which a zone's time is counted, or nothing when it is not tested. Waiting for workers is counted
// to the zone that requested their work, because they do its work. Not tested are the workers, because how much each of
// them does is random, and waiting for another stage, which is not work.
std::string part_of(const ZoneTimes& zone) {
  if (zone.thread == "worker") return "";
  if (zone.name() == "wait for workers") return ZoneTimes{"", zone.path.substr(0, zone.path.rfind('/'))}.name();
  return zone.name().starts_with("wait for") ? "" : zone.name();
}

std::vector<Part> parts_of(const ZoneProfile& profile) {
  std::vector<Part> parts;
  for (const ZoneTimes& zone : profile.zones) {
    const std::string name = part_of(zone);
    if (name.empty()) continue;
    const auto at =
        std::ranges::find_if(parts, [&](const Part& part) { return part.thread == zone.thread && part.name == name; });
    if (at == parts.end()) {
      parts.push_back({zone.thread, name, zone.self_ms});
      continue;
    }
    for (std::size_t repeat = 0; repeat < at->ms.size(); ++repeat) {
      for (std::size_t frame = 0; frame < at->ms[repeat].size(); ++frame)
        at->ms[repeat][frame] += zone.self_ms[repeat][frame];
    }
  }
  return parts;
}

const Part* find(const std::vector<Part>& parts, const Part& wanted) {
  for (const Part& part : parts) {
    if (part.thread == wanted.thread && part.name == wanted.name) return &part;
  }
  return nullptr;
}

bool large_enough(const ZoneProfile& profile, const Part* part) {
  if (part == nullptr) return false;
  const Group all = complement({}, profile.repeats);
  return least_time(part->ms, all) >= least_share * least_time(profile.zones.front().ms, all);
}

// Collects the frame and the parts that occur in both profiles and are large enough in one of them. The names of parts
// that occur in only one profile go to the result.
std::vector<Pooled> tested_zones(const ZoneProfile& before, const ZoneProfile& after, ZoneComparison& result) {
  const ZoneTimes &frame_before = before.zones.front(), &frame_after = after.zones.front();
  const std::vector<Part> parts_before = parts_of(before), parts_after = parts_of(after);
  std::vector<Pooled> tested;
  tested.push_back({{frame_before.thread, "frame"}, pooled(frame_before.ms, frame_after.ms)});
  for (const Part& part : parts_before) {
    const Part* other = find(parts_after, part);
    if (!large_enough(before, &part) && !large_enough(after, other)) continue;
    if (other == nullptr) {
      result.only_before.push_back(part.name);
    } else {
      tested.push_back({{part.thread, part.name}, pooled(part.ms, other->ms)});
    }
  }
  for (const Part& part : parts_after) {
    if (find(parts_before, part) == nullptr && large_enough(after, &part)) result.only_after.push_back(part.name);
  }
  return tested;
}

// Computes log(after / before) of a zone for each regrouping.
std::vector<double> log_ratios(const Times& ms, const std::vector<Group>& groups) {
  std::vector<double> ratios;
  for (const Group& group : groups) {
    const double before = least_time(ms, group);
    const double after = least_time(ms, complement(group, static_cast<int>(ms.size())));
    // The change of a zone that takes no time at all on one side cannot be measured, so a bound stands for it.
    ratios.push_back(before > 0 && after > 0 ? std::log(after / before) : before > 0 ? -50 : after > 0 ? 50 : 0);
  }
  return ratios;
}

// Computes a zone's change relative to that of the rest of the frame, less 1. Where almost nothing remains of the
// frame, it is the zone's own change.
double against_rest(const ZoneChange& zone, const ZoneChange& frame) {
  const bool within = zone.thread == frame.thread;
  const double before = frame.before_ms - (within ? zone.before_ms : 0);
  const double after = frame.after_ms - (within ? zone.after_ms : 0);
  const double least = least_change * frame.before_ms;
  if (before < least || after < least) return zone.change;
  return (1 + zone.change) / (after / before) - 1;
}

// Fills in, for all zones, what follows from the regroupings; the first zone is the frame.
void test(std::vector<Pooled>& zones, const std::vector<Group>& groups) {
  std::vector<double> clearest(groups.size(), 0.0);  // the largest statistic of all zones, for each regrouping
  std::vector<double> own;                           // each zone's statistic as measured
  for (Pooled& zone : zones) {
    std::vector<double> ratios = log_ratios(zone.ms, groups);
    double squares = 0;
    for (const double ratio : ratios) squares += ratio * ratio;
    const double spread = std::max(least_spread, std::sqrt(squares / static_cast<double>(ratios.size())));
    for (std::size_t g = 0; g < groups.size(); ++g) clearest[g] = std::max(clearest[g], std::abs(ratios[g]) / spread);
    own.push_back(std::abs(ratios.front()) / spread);
    const double frames = static_cast<double>(std::max<std::size_t>(1, zone.ms.front().size() - 1));
    zone.change.before_ms = least_time(zone.ms, groups.front()) / frames;
    zone.change.after_ms = least_time(zone.ms, complement(groups.front(), static_cast<int>(zone.ms.size()))) / frames;
    zone.change.change = std::expm1(ratios.front());
    for (double& ratio : ratios) ratio = std::abs(ratio);
    std::ranges::sort(ratios);
    zone.change.noise = std::expm1(ratios[static_cast<std::size_t>(0.95 * static_cast<double>(ratios.size()))]);
  }
  const ZoneChange& frame = zones.front().change;
  for (std::size_t z = 0; z < zones.size(); ++z) {
    const auto as_clear = std::ranges::count_if(clearest, [&](double c) { return c >= own[z] * (1 - 1e-12); });
    ZoneChange& change = zones[z].change;
    change.chance = static_cast<double>(as_clear) / static_cast<double>(groups.size());
    change.against_rest = z == 0 ? 0 : against_rest(change, frame);
    const bool its_own =
        z == 0 || (change.against_rest * change.change > 0 && std::abs(change.against_rest) >= least_change);
    change.named = change.chance <= significance && std::abs(change.change) >= least_change && its_own &&
                   std::abs(change.after_ms - change.before_ms) >= least_share * frame.before_ms;
  }
}

std::string first_difference(const std::string& before, const std::string& after) {
  const auto a = json_if_valid<nlohmann::json>(before), b = json_if_valid<nlohmann::json>(after);
  const auto patch = nlohmann::json::diff(a, b);
  if (patch.empty()) return "";
  const std::string path = patch.front().at("path");
  const nlohmann::json::json_pointer place(path);
  const auto value = [&](const nlohmann::json& json) {
    return json.contains(place) ? exact_json_text(json.at(place)) : "absent";
  };
  return fmt::format("the scenes differ at {}: {} and {}", path, value(a), value(b));
}

}  // namespace

std::vector<std::string> differences(const ProfiledRun& before, const ProfiledRun& after) {
  std::vector<std::string> list;
  const auto same = [&list](const char* what, const auto& a, const auto& b) {
    if (!(a == b)) list.push_back(fmt::format("{} differ: {} and {}", what, a, b));
    return a == b;
  };
  const auto pictures = [](const ProfiledRun& run) { return run.pictures.empty() ? "none" : run.pictures; };
  bool same_scene = same("the scenes", before.scene, after.scene);
  same_scene &= same("the numbers of frames", before.frames, after.frames);
  if (before.replay_json != after.replay_json) list.push_back("the replays differ");
  if (same_scene) {
    if (const std::string at = first_difference(before.scene_json, after.scene_json); !at.empty()) list.push_back(at);
    for (std::size_t i = 0; i < std::min(before.meshes.size(), after.meshes.size()); ++i) {
      same(fmt::format("the meshes of body '{}'", before.meshes[i].first).c_str(), before.meshes[i].second,
           after.meshes[i].second);
    }
  }
  same("the numbers of threads", before.threads, after.threads);
  same("the pictures", pictures(before), pictures(after));
  same("the kernels", before.kernels, after.kernels);
  same("the processors", before.cpu, after.cpu);
  return list;
}

ZoneComparison compare_zones(const ZoneProfile& before, const ZoneProfile& after) {
  ZoneComparison result;
  std::vector<Pooled> zones = tested_zones(before, after, result);
  const std::vector<Group> groups = regroupings(before.repeats + after.repeats, before.repeats);
  test(zones, groups);
  result.regroupings = static_cast<int>(groups.size());
  result.frame = zones.front().change;
  for (std::size_t z = 1; z < zones.size(); ++z) result.zones.push_back(zones[z].change);
  const bool any = std::ranges::any_of(result.zones, &ZoneChange::named);
  result.as_a_whole = result.frame.named && !any;
  result.frame.named &= any;
  result.same_bits = before.run.state_hash == after.run.state_hash;
  return result;
}

namespace {

std::string row_text(const std::string& name, const ZoneChange& zone) {
  return fmt::format("  {:<26}{:>9.3f}{:>9.3f}{:>+9.1f} %{:>+9.1f} %{:>7.1f} %{:>8.3f}{}\n", name, zone.before_ms,
                     zone.after_ms, 100 * zone.change, 100 * zone.against_rest, 100 * zone.noise, zone.chance,
                     !zone.named       ? ""
                     : zone.change > 0 ? "  slower"
                                       : "  faster");
}

}  // namespace

std::string comparison_text(const ZoneComparison& c) {
  std::string text = fmt::format("  {:<26}{:>9}{:>9}{:>11}{:>11}{:>9}{:>8}\n", "ms a frame", "A", "B", "change",
                                 "to rest", "noise", "chance");
  text += row_text("frame, with all in it", c.frame);
  int named = c.frame.named;
  for (const ZoneChange& zone : c.zones) {
    text += row_text(zone.thread == c.frame.thread ? zone.name : zone.thread + ": " + zone.name, zone);
    named += zone.named;
  }
  for (const std::string& path : c.only_before) text += fmt::format("  only in A: {}\n", path);
  for (const std::string& path : c.only_after) text += fmt::format("  only in B: {}\n", path);
  text += fmt::format(
      "\n  {}\n"
      "  A zone's time is summed over all its places, without the zones within: the least of the repeats for each "
      "frame, without\n  the first frame. A zone is named when it changed by {:g} % or more, also against the rest of "
      "the frame, and by {:g} % of\n  the frame or more, and when, of {} ways to deal the repeats to A and B, at most "
      "{:g} % show any zone that changes as\n  clearly, measured by its own spread.\n",
      named == 0
          ? "No zone became slower or faster beyond the noise."
          : fmt::format("{} became slower or faster beyond the noise.", named == 1 ? "One" : std::to_string(named)),
      100 * least_change, 100 * least_share, c.regroupings, 100 * significance);
  if (c.as_a_whole)
    text +=
        "  The frame changed as a whole, and no zone more than the others: the cause is the build, or the state of the "
        "machine\n  during those minutes.\n";
  if (!c.same_bits) text += "  The runs end in different states: they did not do the same work.\n";
  return text;
}

std::string comparison_json(const ZoneComparison& c) {
  using Json = nlohmann::ordered_json;
  const auto row = [](const ZoneChange& z) {
    return Json{{"thread", z.thread},     {"zone", z.name},     {"before_ms", z.before_ms},
                {"after_ms", z.after_ms}, {"change", z.change}, {"against_rest", z.against_rest},
                {"noise", z.noise},       {"chance", z.chance}, {"named", z.named}};
  };
  Json json = {{"regroupings", c.regroupings},

               {"as_a_whole", c.as_a_whole},
               {"same_bits", c.same_bits},
               {"frame", row(c.frame)}};
  json["zones"] = Json::array();
  for (const ZoneChange& zone : c.zones) json["zones"].push_back(row(zone));
  json["only_before"] = c.only_before;
  json["only_after"] = c.only_after;
  return json_text(json) + "\n";
}

}  // namespace supple
