#include "output/unsolved.h"

#include <fmt/core.h>

#include <algorithm>
#include <set>

namespace supple {
namespace {

constexpr double worst_estimate = 0.1;
constexpr double most_trials = 4;

}  // namespace

std::vector<UnsolvedStep> unsolved_steps(const std::vector<FrameRow>& rows) {
  std::vector<UnsolvedStep> list;
  for (const FrameRow& row : rows) {
    for (const BodyRow& body : row.bodies) {
      const double trials = body.iterations > 0 ? static_cast<double>(body.line_search) / body.iterations : 0;
      if (body.error_estimate > worst_estimate || trials > most_trials)
        list.push_back({row.frame, body.name, body.error_estimate, trials});
    }
  }
  return list;
}

std::string unsolved_text(const std::vector<FrameRow>& rows) {
  const std::vector<UnsolvedStep> list = unsolved_steps(rows);
  if (list.empty()) return "";
  std::set<int> frames;
  std::vector<UnsolvedStep> worst;  // of each body
  for (const UnsolvedStep& step : list) {
    frames.insert(step.frame);
    const auto at = std::ranges::find(worst, step.body, &UnsolvedStep::body);
    if (at == worst.end()) {
      worst.push_back(step);
    } else if (step.error_estimate > at->error_estimate) {
      *at = step;
    }
  }
  std::string text = fmt::format("{} of {} frames did not come near their solution:", frames.size(), rows.size());
  for (const UnsolvedStep& step : worst) {
    text += fmt::format("{} body '{}' worst in frame {}, with an error of about {:.2g} and {:.1f} trials an iteration",
                        &step == &worst.front() ? "" : ";", step.body, step.frame, step.error_estimate, step.trials);
  }
  return text + "; more iterations or substeps help";
}

}  // namespace supple
