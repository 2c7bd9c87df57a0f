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

std::vector<CutsByFrame> repeated_cuts(const PlayedSession& session, const std::vector<std::string>& bodies) {
  if (session.hashes.empty()) return {};
  std::vector<CutsByFrame> result(bodies.size(), CutsByFrame(session.hashes.size()));
  for (const PlayedCut& cut : session.cuts) {
    const auto body = std::ranges::find(bodies, cut.body);
    constexpr int most_substeps = 1000;  // that a scene may have
    if (body == bodies.end() || cut.frame < 0 || cut.frame >= std::ssize(session.hashes) || cut.substep < 0 ||
        cut.substep >= most_substeps) {
      throw InputError("[session] of the replay",
                       fmt::format("cuts: body '{}', frame {}, substep {}: the session has no such step", cut.body,
                                   cut.frame, cut.substep));
    }
    std::vector<BudgetCuts>& of_frame = result[std::size_t(body - bodies.begin())][std::size_t(cut.frame)];
    if (std::ssize(of_frame) <= cut.substep) of_frame.resize(std::size_t(cut.substep) + 1);
    of_frame[std::size_t(cut.substep)] = cut.cuts;
  }
  return result;
}

std::optional<BudgetCuts> cuts_at(const CutsByFrame& cuts, int frame, int substep) {
  const std::vector<BudgetCuts>& of_frame = cuts.at(std::size_t(frame));
  if (substep >= std::ssize(of_frame)) return std::nullopt;
  return of_frame[std::size_t(substep)];
}

}  // namespace supple
