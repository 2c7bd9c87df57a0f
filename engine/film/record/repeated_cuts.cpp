#include "film/record/repeated_cuts.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "output/run/profile.h"

namespace supple {
namespace {

// Returns the cuts of a body in one frame. A body without a budget there has none.
std::vector<BudgetCuts> cuts_in(const FrameRow& frame, const std::string& body, const std::string& source) {
  const auto row = std::ranges::find(frame.bodies, body, &BodyRow::name);
  if (row == frame.bodies.end()) throw InputError(source, fmt::format("has no body '{}'", body));
  std::vector<BudgetCuts> cuts;
  for (const std::array<int, 2>& after : row->budget_cuts) cuts.push_back({after});
  return cuts;
}

}  // namespace

std::vector<CutsByFrame> repeated_cuts(const std::filesystem::path& run, const std::vector<std::string>& bodies,
                                       int frames) {
  const std::string source = "--repeat " + run.string();
  const std::vector<FrameRow> rows = read_profile(run / "profile.json");
  if (int(rows.size()) < frames)
    throw InputError(source, fmt::format("has {} frames, and the film has {}: shorten it (--frames {})", rows.size(),
                                         frames, rows.size()));
  bool any = false;
  std::vector<CutsByFrame> result;
  for (const std::string& body : bodies) {
    CutsByFrame& cuts = result.emplace_back();
    for (int frame = 0; frame < frames; ++frame) {
      cuts.push_back(cuts_in(rows[std::size_t(frame)], body, source));
      any |= !cuts.back().empty();
    }
  }
  if (!any) throw InputError(source, "no step of that run had a budget of time (solver.budget_ms)");
  return result;
}

}  // namespace supple
