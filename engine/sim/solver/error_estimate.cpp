#include "sim/solver/error_estimate.h"

#include <algorithm>
#include <cmath>

#include "sim/solver/line_search.h"

namespace supple {

// The factor would be 1 if the matrix of d, corrected by L-BFGS, were the Hessian. docs/method.md says how it was
// found.
double left_by_decrement(double decrement) {
  constexpr double share_of_decrement = 2;
  return share_of_decrement * decrement;
}

// Decreases of quasi-Newton iterations shrink unevenly, so the ratio is averaged over the last three. Where there are
// too few, the estimate is as much again as was gained.
double left_by_decreases(const std::vector<double>& g, std::size_t first) {
  const std::size_t steps = g.size() - 1 - first;
  if (steps < 2) return steps == 0 ? 0 : std::max(0.0, g[first] - g[first + 1]);
  const double last = g[g.size() - 2] - g.back();
  const std::size_t back = std::min<std::size_t>(3, steps - 1);
  const double earlier = g[g.size() - 2 - back] - g[g.size() - 1 - back];
  if (last <= 0 || earlier <= 0) return 0;
  const double ratio = std::min(0.95, std::pow(last / earlier, 1.0 / static_cast<double>(back)));
  return last * ratio / (1 - ratio);
}

double error_of(double left, double gained) { return left > 0 ? left / (std::max(gained, 0.0) + left) : 0; }

bool is_near_enough(const StepReport& report, const SolverSettings& solver) {
  return solver.target_error > 0 && error_of(report.remaining_estimate, report.decrease) < solver.target_error;
}

double error_at_end(const Model& model, const Workspace& w, double gained) {
  const double left = w.report.remaining_estimate;
  if (left <= noise_of(model, w.current.g, extent_of(model, w))) return 0;
  // A contact that is found on the way raises g, which takes nothing from what the searches gained.
  double searched = 0;
  for (const IterationRecord& iteration : w.report.records) searched += std::max(0.0, iteration.decrease);
  return error_of(left, std::max(gained, searched));
}

}  // namespace supple
