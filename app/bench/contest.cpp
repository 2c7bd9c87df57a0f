#include "app/bench/contest.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "app/frame_loop.h"
#include "base/error.h"

namespace supple {

SearchRule& Contest::rule_of(const Contestant& contestant) {
  const auto same = [&](const Prepared& p) { return p.method == contestant.method; };
  const auto at = std::find_if(prepared_.begin(), prepared_.end(), same);
  if (at != prepared_.end()) return *at->rule;
  prepared_.push_back({contestant.method, make_rule(contestant.method, subject_.model)});
  return *prepared_.back().rule;
}

namespace {

// Adds one timed run of the contestant to what is known of it.
void add_times(Outcome& outcome, const StepReport& report) {
  std::vector<double> ms = {report.start_ms};
  for (const IterationRecord& record : report.history) ms.push_back(record.elapsed_ms);
  outcome.steps.push_back(report.step_ms);
  outcome.overheads.push_back(report.lbfgs_ms);
  if (outcome.ms.empty()) {
    outcome.ms = ms;
    return;
  }
  SUPPLE_CHECK(ms.size(), ==, outcome.ms.size());  // the same bits each time
  for (std::size_t k = 0; k < ms.size(); ++k) outcome.ms[k] = std::min(outcome.ms[k], ms[k]);
}

}  // namespace

// Repeats are the outer loop: what slows the machine for a while slows all. The first round warms caches and tells what
// happened; it counts for no time.
std::vector<Outcome> Contest::run(const BenchState& state, const std::vector<Contestant>& contestants, int repeats,
                                  double budget_ms) {
  std::vector<Outcome> outcomes(contestants.size());
  for (int repeat = 0; repeat <= std::max(repeats, 1); ++repeat) {
    for (std::size_t m = 0; m < contestants.size(); ++m) {
      if (interrupted()) throw ContestInterrupted{};
      Outcome& outcome = outcomes[m];
      if (outcome.failed || (repeat > 1 && outcome.used_ms > budget_ms)) continue;
      const FrameInputs inputs = inputs_of(state, contestants[m]);
      SearchRule& rule = rule_of(contestants[m]);
      State after = state.before;
      workspace_.correction = {};  // what one contestant learned of A^-1 is not a present to the next
      const StepReport& report = step(subject_.model, inputs, after, workspace_, rule);
      outcome.used_ms += report.step_ms;
      if (repeat > 0) {
        add_times(outcome, report);
        continue;
      }
      outcome.label = contestants[m].label;
      outcome.failed = report.failed;
      outcome.stop_reason = report.stop_reason;
      outcome.iterations = report.iterations;
      outcome.trials = report.line_search;
      outcome.history = report.history;
      outcome.x = after.x;
      if (report.failed) continue;
      // From the end backwards, so that what is nearly the minimum is known to the last digits.
      double left = gained(subject_.model, inputs, state.before, outcome.x, reference_workspace_);
      outcome.gained.assign(outcome.history.size() + 1, left);
      for (std::size_t k = outcome.history.size(); k-- > 0;) {
        left -= outcome.history[k].decrease;
        outcome.gained[k] = left;
      }
    }
  }
  for (Outcome& outcome : outcomes) {
    if (outcome.failed) {
      outcome.step_ms = outcome.median_ms = outcome.overhead_ms = std::nan("");
      continue;
    }
    std::sort(outcome.steps.begin(), outcome.steps.end());
    std::sort(outcome.overheads.begin(), outcome.overheads.end());
    outcome.step_ms = outcome.steps.front();
    outcome.median_ms = outcome.steps[outcome.steps.size() / 2];
    outcome.overhead_ms = outcome.overheads[outcome.overheads.size() / 2];
  }
  return outcomes;
}

FrameInputs Contest::inputs_of(const BenchState& state, const Contestant& contestant) const {
  FrameInputs inputs = subject_.inputs(state.frame);
  inputs.solver.iterations = contestant.iterations;
  inputs.solver.history = contestant.history;
  inputs.solver.line_search = contestant.line_search;
  inputs.solver.chebyshev = contestant.chebyshev;
  inputs.solver = settings_of(contestant.method, inputs.solver);
  return inputs;
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

double last_error(const Outcome& outcome, double whole) {
  return outcome.failed ? std::nan("") : (whole - outcome.gained.back()) / whole;
}

double time_to(const Outcome& outcome, double whole, double tolerance) {
  for (std::size_t k = 0; k < outcome.gained.size(); ++k) {
    if (whole - outcome.gained[k] <= tolerance * whole) return outcome.ms[k];
  }
  return std::numeric_limits<double>::infinity();
}

ChebyshevSettings trained_chebyshev(Contest& contest, const BenchState& training) {
  ChebyshevSettings best{10, 0.99};
  double most = -std::numeric_limits<double>::infinity();
  for (const double radius : {0.8, 0.9, 0.95, 0.97, 0.98, 0.99, 0.995, 0.999}) {
    Contestant contestant{"", Method::chebyshev, 30};
    contestant.chebyshev = {best.delay, radius};
    const Outcome outcome = contest.run(training, {contestant}, 0).front();
    if (outcome.failed || outcome.gained.back() <= most) continue;
    most = outcome.gained.back();
    best.radius = radius;
  }
  return best;
}

}  // namespace supple
