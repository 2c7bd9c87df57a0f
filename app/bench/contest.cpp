#include "app/bench/contest.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "app/frame_loop.h"

namespace supple {

SearchRule& Contest::rule_of(const Contestant& contestant) {
  const auto same = [&](const Prepared& p) {
    return p.method == contestant.method && p.settings.chebyshev_radius == contestant.rule.chebyshev_radius &&
           p.settings.chebyshev_delay == contestant.rule.chebyshev_delay;
  };
  const auto at = std::find_if(prepared_.begin(), prepared_.end(), same);
  if (at != prepared_.end()) return *at->rule;
  prepared_.push_back(
      {contestant.method, contestant.rule, make_rule(contestant.method, subject_.model, contestant.rule)});
  return *prepared_.back().rule;
}

std::vector<Outcome> Contest::run(const BenchState& state, const std::vector<Contestant>& contestants, int repeats,
                                  double budget_ms) {
  std::vector<Outcome> outcomes;
  for (const Contestant& contestant : contestants) {
    if (interrupted()) throw ContestInterrupted{};
    SearchRule& rule = rule_of(contestant);
    FrameInputs inputs = subject_.inputs(state.frame);
    inputs.solver.iterations = contestant.iterations;
    inputs.solver.history = contestant.history;
    inputs.solver.line_search = contestant.line_search;
    inputs.solver = settings_of(contestant.method, inputs.solver);
    Outcome outcome;
    outcome.label = contestant.label;
    std::vector<double> times, overheads;
    double used = 0;
    for (int repeat = 0; repeat <= repeats; ++repeat) {
      State after = state.before;
      const StepReport& report = step(subject_.model, inputs, after, workspace_, rule);
      used += report.step_ms;
      const bool last = repeat == repeats || used > budget_ms;
      if (repeat == 0) {
        outcome.failed = report.failed;
        outcome.iterations = report.iterations;
        outcome.trials = report.line_search;
        outcome.history = report.history;
        outcome.x = after.x;
        if (report.failed) break;
        if (!last) continue;  // it warmed the caches
      }
      times.push_back(report.step_ms);
      overheads.push_back(report.lbfgs_ms);
      std::vector<double> ms = {report.start_ms};
      for (const IterationRecord& record : report.history) ms.push_back(record.elapsed_ms);
      if (outcome.ms.empty()) {
        outcome.ms = ms;
      } else {
        for (std::size_t k = 0; k < ms.size(); ++k) outcome.ms[k] = std::min(outcome.ms[k], ms[k]);
      }
      if (last) break;
    }
    if (!outcome.failed) {
      std::sort(times.begin(), times.end());
      std::sort(overheads.begin(), overheads.end());
      outcome.step_ms = times.front();
      outcome.median_ms = times[times.size() / 2];
      outcome.overhead_ms = overheads[overheads.size() / 2];
      // From the end backwards, so that what is nearly the minimum is known to the last digits.
      double left = gained(subject_.model, inputs, state.before, outcome.x, workspace_);
      outcome.gained.assign(outcome.history.size() + 1, left);
      for (std::size_t k = outcome.history.size(); k-- > 0;) {
        left -= outcome.history[k].decrease;
        outcome.gained[k] = left;
      }
    }
    outcomes.push_back(std::move(outcome));
  }
  return outcomes;
}

Minimum Contest::reference(const BenchState& state, const std::vector<Outcome>& outcomes) {
  const auto better = [](const Outcome& a, const Outcome& b) {
    const double none = -std::numeric_limits<double>::infinity();
    return (a.failed ? none : a.gained.back()) < (b.failed ? none : b.gained.back());
  };
  const Outcome& best = *std::max_element(outcomes.begin(), outcomes.end(), better);
  const FrameInputs inputs = subject_.inputs(state.frame);
  return lowest_.minimum(subject_.model, inputs, state.before, best.failed ? state.before.x : best.x,
                         reference_workspace_);
}

std::vector<double> errors_of(const Outcome& outcome, double whole) {
  std::vector<double> errors;
  for (const double gain : outcome.gained) errors.push_back((whole - gain) / whole);
  return errors;
}

double time_to(const Outcome& outcome, double whole, double tolerance) {
  for (std::size_t k = 0; k < outcome.gained.size(); ++k) {
    if (whole - outcome.gained[k] <= tolerance * whole) return outcome.ms[k];
  }
  return std::numeric_limits<double>::infinity();
}

RuleSettings trained_chebyshev(Contest& contest, const BenchState& training) {
  RuleSettings best;
  double most = -std::numeric_limits<double>::infinity();
  for (const double radius : {0.8, 0.9, 0.95, 0.97, 0.98, 0.99, 0.995, 0.999}) {
    Contestant contestant{"", Method::chebyshev, 30};
    contestant.rule.chebyshev_radius = radius;
    const Outcome outcome = contest.run(training, {contestant}, 0).front();
    if (outcome.failed || outcome.gained.back() <= most) continue;
    most = outcome.gained.back();
    best.chebyshev_radius = radius;
  }
  return best;
}

}  // namespace supple
