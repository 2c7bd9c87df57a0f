// Shows a profile to people: zones with their distributions, missed deadlines and slow frames, and the plot of its
// frames.
#pragma once

#include "output/pages/report_plot.h"
#include "output/run/profile.h"
#include "output/run/zones.h"

namespace supple {

// Summarises all repeats together; the first frame of each is left out, except in `first`.
struct ZoneSummary {
  std::string thread, path;
  double calls = 0;       // calls in a frame
  double first = 0;       // in the first frame, median of the repeats [ms]
  Distribution frames;    // by frame [ms]
  double share = 0;       // of the time of all frames
  double self_share = 0;  // the same without the zones within; over the zones of the frames' thread they add up to 1
};
std::vector<ZoneSummary> summarize(const ZoneProfile& profile);

// Counts the frames that took longer than the film's rate allows.
struct Deadline {
  double ms = 0;       // 1000 / fps
  long frames = 0;     // of all repeats, except for the first of each
  long late_wall = 0;  // by the time from a frame's begin to its end on its thread, with waiting for later stages
  long late_work = 0;  // by the sum of its stages: step, draw list, render and compress
};
Deadline deadline_of(const ZoneProfile& profile);

// Describes one of the slowest frames, by the median of the repeats, and the zone that has most of its excess over the
// median frame.
struct SlowFrame {
  int frame = 0;
  double ms = 0;
  std::string zone;  // empty: no zone takes longer than in the median frame
  double excess_ms = 0;
};
std::vector<SlowFrame> slow_frames(const ZoneProfile& profile, std::size_t count);

std::string zone_table(const ZoneProfile& profile);
std::string summary_json(const ZoneProfile& profile);

// Plots frame times by stage over the frames, as medians of the repeats, for frame-times.csv and .svg.
ReportPlot frame_time_plot(const ZoneProfile& profile);

}  // namespace supple
