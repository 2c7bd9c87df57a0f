#include "output/run/profile.h"

#include <algorithm>
#include <cmath>

#include "output/run/row_tally.h"

namespace supple {

Distribution distribution_of(std::vector<double> values) {
  Distribution d;
  if (values.empty()) return d;
  std::sort(values.begin(), values.end());
  const auto rank = [&](double share) {
    const auto index = static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size())));
    return values[std::clamp<std::size_t>(index, 1, values.size()) - 1];
  };
  d.p50 = rank(0.50);
  d.p95 = rank(0.95);
  d.p99 = rank(0.99);
  d.max = values.back();
  for (const double value : values) d.total += value;
  d.mean = d.total / static_cast<double>(values.size());
  return d;
}

std::vector<StageSummary> summarize(const std::vector<FrameRow>& rows) { return RowTally(rows).stages(); }
std::vector<std::string> warnings_of(const std::vector<FrameRow>& rows) { return RowTally(rows).warnings(); }
std::vector<std::string> penetration_warnings(const std::vector<FrameRow>& rows) {
  return RowTally(rows).penetration_warnings();
}
std::string profile_table(const std::vector<FrameRow>& rows) { return RowTally(rows).table(); }

}  // namespace supple
