// What a profile says to people: zones with their distributions, missed deadlines, slow frames; and the plot of its
// frames.
#pragma once

#include "output/profile.h"
#include "output/report_plot.h"
#include "output/zones.h"

namespace supple {

// All repeats together, the first frame of each left out.
struct ZoneSummary {
  std::string thread, path;
  double calls = 0;       // a frame
  double first = 0;       // in the first frame, median of the repeats [ms]
  Distribution frames;    // by frame [ms]
  double share = 0;       // of the time of all frames
  double self_share = 0;  // the same without the zones within; those of the frames' thread add up to 1
};
std::vector<ZoneSummary> summarize(const ZoneProfile& profile);

// Frames that took longer than the film's rate allows.
struct Deadline {
  double ms = 0;       // 1000 / fps
  long frames = 0;     // of all repeats, the first of each left out
  long late_wall = 0;  // by the time from the frame's begin to its end on its thread, waiting for later stages included
  long late_work = 0;  // by what its stages take one after the other: step, draw list, render and encode
};
Deadline deadline_of(const ZoneProfile& profile);

// By the median of the repeats, slowest first; where most of a frame's excess over the median frame is.
struct SlowFrame {
  int frame = 0;
  double ms = 0;
  std::string zone;  // empty: no zone takes longer than in the median frame
  double excess_ms = 0;
};
std::vector<SlowFrame> slow_frames(const ZoneProfile& profile, std::size_t count);

std::string zone_table(const ZoneProfile& profile);
std::string summary_json(const ZoneProfile& profile);

// Frame times by stage over frames, medians of the repeats, as frame-times.csv and .svg.
ReportPlot frame_time_plot(const ZoneProfile& profile);

}  // namespace supple
