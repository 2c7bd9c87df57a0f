// The points of a sweep as tables: what they gave, and what the clock said.
#pragma once

#include "app/sweep/point.h"
#include "output/profile.h"
#include "output/report_table.h"

namespace supple {

// The results of a point in short: it may have many rows.
struct PointResult {
  PointOutcome outcome;
  std::size_t frames = 0;        // that are whole; 0 where there are none of this scene and program
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

// A table with a row a point: its values, how it ended, and numbers with all digits, which do not depend on the machine
// and on the clock.
ReportTable sweep_table(const SweepDef& sweep, const std::vector<PointResult>& results);

// A table with a row a point: its times, in milliseconds and seconds.
ReportTable times_table(const std::vector<PointResult>& results);

}  // namespace supple
