#include "output/pages/zone_table.h"

#include <fmt/core.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/text.h"
#include "output/files/json_text.h"
#include "output/run/verdict.h"

namespace supple {
namespace {

constexpr double least_shown = 0.001;  // share of the frame below which zones have no row of their own

using Times = std::vector<std::vector<double>>;

// Returns the first frame that counts: the very first one is left out, unless it is the only one.
std::size_t first_counted(const ZoneProfile& profile) { return profile.run.frames > 1 ? 1 : 0; }

std::vector<double> counted(const ZoneProfile& profile, const Times& ms) {
  std::vector<double> values;
  for (const std::vector<double>& frames : ms)
    values.insert(values.end(), frames.begin() + static_cast<long>(first_counted(profile)), frames.end());
  return values;
}

double sum(const std::vector<double>& values) {
  double total = 0;
  for (const double value : values) total += value;
  return total;
}

double median_of(std::vector<double> values) { return distribution_of(std::move(values)).p50; }

double median_of(const Times& ms, std::size_t frame) {
  std::vector<double> values;
  for (const std::vector<double>& frames : ms) values.push_back(frames[frame]);
  return median_of(std::move(values));
}

std::vector<double> medians_of(const Times& ms) {
  std::vector<double> medians;
  for (std::size_t frame = 0; frame < ms.front().size(); ++frame) medians.push_back(median_of(ms, frame));
  return medians;
}

std::string row_of(const std::string& name, const ZoneSummary& row) {
  return fmt::format("  {:<34}{:>7.1f}{:>9.3f}{:>9.3f}{:>9.3f}{:>9.3f}{:>9.3f}{:>10.2f}{:>8.1f}{:>8.1f}\n", name,
                     row.calls, row.frames.p50, row.frames.p95, row.frames.p99, row.frames.max, row.first,
                     row.frames.total / 1000, 100 * row.share, 100 * row.self_share);
}

std::string share_row(const std::string& name, double self_share) {
  return fmt::format("  {:<34}{:>78.1f}\n", name, 100 * self_share);
}

std::string indented(const std::string& path) {
  const auto depth = static_cast<std::size_t>(std::ranges::count(path, '/'));
  return std::string(2 * depth, ' ') + path.substr(path.rfind('/') + 1);
}

// Writes the table of zones without its heading.
std::string zone_rows(const std::vector<ZoneSummary>& rows) {
  const std::string& frame_thread = rows.front().thread;
  std::string text = row_of("frame", rows.front());
  double hidden = 0;
  std::size_t i = 1;
  for (; i < rows.size() && rows[i].thread == frame_thread; ++i) {
    if (rows[i].share < least_shown) {
      hidden += rows[i].self_share;
    } else {
      text += row_of(indented(rows[i].path), rows[i]);
    }
  }
  if (hidden > 0) text += share_row("  smaller zones", hidden);
  text += share_row("  outside zones", rows.front().self_share);
  std::string thread;
  for (; i < rows.size(); ++i) {
    if (rows[i].share < least_shown) continue;
    if (rows[i].thread != thread) text += fmt::format("  meanwhile, {}\n", thread = rows[i].thread);
    text += row_of("  " + indented(rows[i].path), rows[i]);
  }
  return text;
}

std::string deadline_text(const Deadline& deadline) {
  return fmt::format(
      "  Deadline {:.1f} ms: of {} frames {} are late by wall time (from a frame's begin to its end on the thread that "
      "makes it,\n  including the wait for later stages), {} by work (the sum of its step, draw list, render and "
      "compress).\n",
      deadline.ms, deadline.frames, deadline.late_wall, deadline.late_work);
}

std::string setup_text(const ZoneProfile& profile) {
  std::string text = "  Before and after the frames (median):";
  for (std::size_t i = 0; i < profile.setup.size(); ++i)
    text += fmt::format("{} {} {:.1f} ms", i == 0 ? "" : ",", profile.setup[i].name, median_of(profile.setup[i].ms));
  return text + "\n";
}

std::string slow_text(const ZoneProfile& profile) {
  std::string text = "  Slowest frames (median of the repeats):";
  const char* between = "";
  for (const SlowFrame& slow : slow_frames(profile, 3)) {
    text += fmt::format("{} {} {:.2f} ms", between, slow.frame, slow.ms);
    if (!slow.zone.empty()) text += fmt::format(" ({} {:+.2f} ms)", slow.zone, slow.excess_ms);
    between = ",";
  }
  return text + "\n";
}

}  // namespace

std::vector<ZoneSummary> summarize(const ZoneProfile& profile) {
  const double all = sum(counted(profile, profile.zones.front().ms));
  std::vector<ZoneSummary> rows;
  for (const ZoneTimes& zone : profile.zones) {
    ZoneSummary row{zone.thread, zone.path, zone.calls, median_of(zone.ms, 0), {}, 0, 0};
    row.frames = distribution_of(counted(profile, zone.ms));
    row.share = row.frames.total / all;
    row.self_share = sum(counted(profile, zone.self_ms)) / all;
    rows.push_back(std::move(row));
  }
  return rows;
}

Deadline deadline_of(const ZoneProfile& profile) {
  Deadline deadline{1000 / profile.run.fps};
  std::vector<const ZoneTimes*> stages;
  for (const ZoneTimes& zone : profile.zones) {
    for (const char* stage : {"frame/step", "frame/draw list", "render", "compress"}) {
      if (zone.path == stage) stages.push_back(&zone);
    }
  }
  for (int repeat = 0; repeat < profile.repeats; ++repeat) {
    for (std::size_t frame = first_counted(profile); frame < std::size_t(profile.run.frames); ++frame) {
      double work = 0;
      for (const ZoneTimes* stage : stages) work += stage->ms[repeat][frame];
      ++deadline.frames;
      deadline.late_wall += profile.zones.front().ms[repeat][frame] > deadline.ms;
      deadline.late_work += work > deadline.ms;
    }
  }
  return deadline;
}

std::vector<SlowFrame> slow_frames(const ZoneProfile& profile, std::size_t count) {
  const std::vector<double> ms = medians_of(profile.zones.front().ms);
  std::vector<SlowFrame> list;
  for (std::size_t frame = first_counted(profile); frame < ms.size(); ++frame)
    list.push_back({static_cast<int>(frame), ms[frame], "", 0});
  std::ranges::stable_sort(list, std::greater{}, &SlowFrame::ms);
  list.resize(std::min(list.size(), count));
  for (const ZoneTimes& zone : profile.zones) {
    if (zone.thread != profile.zones.front().thread) continue;
    const std::vector<double> self = medians_of(zone.self_ms);
    const double usual = median_of(self);
    for (SlowFrame& slow : list) {
      const double excess = self[slow.frame] - usual;
      if (excess <= slow.excess_ms) continue;
      slow.zone = zone.path.substr(zone.path.find('/') + 1);
      slow.excess_ms = excess;
    }
  }
  return list;
}

std::string zone_table(const ZoneProfile& profile) {
  std::string text = fmt::format("  {:<34}{:>7}{:>9}{:>9}{:>9}{:>9}{:>9}{:>10}{:>8}{:>8}\n", "ms a frame", "calls",
                                 "p50", "p95", "p99", "max", "first", "total s", "share %", "self %");
  text += zone_rows(summarize(profile));
  text += fmt::format("\n  {} of {} together; the first frame of each is shown apart.\n",
                      count_text(profile.repeats, "repeat"), count_text(profile.run.frames, "frame"));
  return text + setup_text(profile) + deadline_text(deadline_of(profile)) + slow_text(profile);
}

std::string summary_json(const ZoneProfile& profile) {
  using Json = nlohmann::ordered_json;
  const Deadline deadline = deadline_of(profile);
  Json json = {{"scene", profile.run.scene}, {"frames", profile.run.frames}, {"repeats", profile.repeats}};
  json["deadline"] = {{"ms", deadline.ms},
                      {"frames", deadline.frames},
                      {"late_wall", deadline.late_wall},
                      {"late_work", deadline.late_work}};
  json["verdict"] = verdict(work_of(profile));
  for (const SlowFrame& slow : slow_frames(profile, 3))
    json["slow_frames"].push_back({{"frame", slow.frame}, {"ms", slow.ms}, {"zone", slow.zone}});
  for (const SetupTimes& row : profile.setup) json["setup_ms"][row.name] = median_of(row.ms);
  for (const ZoneSummary& row : summarize(profile)) {
    json["zones"].push_back({{"thread", row.thread},
                             {"zone", row.path},
                             {"calls_a_frame", row.calls},
                             {"p50_ms", row.frames.p50},
                             {"p95_ms", row.frames.p95},
                             {"p99_ms", row.frames.p99},
                             {"max_ms", row.frames.max},
                             {"first_ms", row.first},
                             {"total_ms", row.frames.total},
                             {"share", row.share},
                             {"self_share", row.self_share}});
  }
  return json_text(json) + "\n";
}

ReportPlot frame_time_plot(const ZoneProfile& profile) {
  ReportPlot plot{"frame-times", fmt::format("Frame times of {}, medians of {}", profile.run.scene,
                                             count_text(profile.repeats, "repeat"))};
  plot.x_label = "frame";
  plot.y_label = "ms";
  plot.log_y = false;
  std::vector<double> numbers;
  for (int frame = 0; frame < profile.run.frames; ++frame) numbers.push_back(frame);
  const std::vector<ZoneSummary> rows = summarize(profile);
  double most = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const ZoneTimes& zone = profile.zones[i];
    const bool frame = i == 0, of_frame = zone.thread == profile.zones.front().thread;
    if (zone.depth() > 1 || (of_frame ? !frame && zone.depth() != 1 : zone.depth() != 0)) continue;
    if (rows[i].share < 0.01 || zone.thread == "worker") continue;
    std::vector<double> ms = medians_of(zone.ms);
    most = std::max(most, *std::ranges::max_element(ms));
    plot.series.push_back({zone.name(), numbers, std::move(ms), frame});
  }
  const double deadline = 1000 / profile.run.fps;
  if (deadline < 3 * most) plot.series.push_back({"deadline", {0, numbers.back()}, {deadline, deadline}, false, true});
  return plot;
}

}  // namespace supple
