// Makes tables of the points of a sweep: their results and their times.
#pragma once

#include "app/sweep/point.h"
#include "output/pages/report_table.h"
#include "output/run/profile.h"

namespace supple {

// Holds a summary of a point's results, without the rows of its frames, which may be many.
struct PointResult {
  PointOutcome outcome;
  std::size_t frames = 0;        // how many are whole; 0 where there are none of this scene and program
  std::uint64_t state_hash = 0;  // of the last one
  struct BodyMeasures {
    std::string name;
    std::vector<std::optional<double>> values;  // in the order of the table's measures
  };
  std::vector<BodyMeasures> bodies;
  Distribution step_ms;      // without the first frame
  std::string cpu, kernels;  // of the machine that ran it
};

std::vector<PointResult> read_results(const SweepRequest& request);

// Makes a table with one row for each point: its values, how it ended, and results with all digits, which do not depend
// on the machine or on the clock.
ReportTable sweep_table(const SweepDef& sweep, const std::vector<PointResult>& results);

// Makes a table with one row for each point: its times, in milliseconds and seconds.
ReportTable times_table(const std::vector<PointResult>& results);

}  // namespace supple
