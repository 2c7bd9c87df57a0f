#include "app/bench/comparison.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/interrupts.h"
#include "sim/model/motion_error.h"
#include "sim/solver/first_iterate.h"
#include "sim/solver/matrix_rule.h"

namespace supple {

SearchRule& SolverComparison::rule_of(const SolverEntry& entry) {
  const auto same = [&](const Prepared& p) { return p.method == entry.method && p.maker == entry.maker; };
  const auto at = std::find_if(prepared_.begin(), prepared_.end(), same);
  if (at != prepared_.end()) return *at->rule;
  const Model& model = subject_.model();
  prepared_.push_back(
      {entry.method, entry.maker, entry.maker != nullptr ? entry.maker(model) : make_rule(entry.method, model)});
  return *prepared_.back().rule;
}

namespace {

// Adds one timed run of a solver to its outcome.
void add_times(Outcome& outcome, const StepReport& report) {
  std::vector<double> ms = {report.start_ms};
  for (const IterationRecord& record : report.records) ms.push_back(record.elapsed_ms);
  outcome.steps.push_back(report.step_ms);
  outcome.overheads.push_back(report.lbfgs_ms);
  outcome.matrix_ms = outcome.ms.empty() ? report.matrix_ms : std::min(outcome.matrix_ms, report.matrix_ms);
  if (outcome.ms.empty()) {
    outcome.ms = ms;
    return;
  }
  SUPPLE_CHECK(ms.size(), ==, outcome.ms.size());  // each run gives the same bits
  for (std::size_t k = 0; k < ms.size(); ++k) outcome.ms[k] = std::min(outcome.ms[k], ms[k]);
}

}  // namespace

// The repeats are the outer loop, so that a disturbance that slows the machine for a while slows all solvers. The first
// round warms the caches and gives the results; its times do not count.
std::vector<Outcome> SolverComparison::run(const BenchState& state, const std::vector<SolverEntry>& entries,
                                           int repeats, double budget_ms) {
  std::vector<Outcome> outcomes(entries.size());
  for (int repeat = 0; repeat <= std::max(repeats, 1); ++repeat) {
    for (std::size_t m = 0; m < entries.size(); ++m) {
      if (interrupted()) throw BenchInterrupted{};
      Outcome& outcome = outcomes[m];
      if (outcome.failed || (repeat > 1 && outcome.used_ms > budget_ms)) continue;
      const StepInputs inputs = inputs_of(state, entries[m]);
      SearchRule& rule = rule_of(entries[m]);
      State after = state.before;
      workspace_.correction = {};  // no solver may use what another one learned of A^-1
      // The run is given the matrix that a film would already have at this step.
      prepare_matrix(subject_.model(), inputs.solver, state.before, workspace_);
      if (repeat == 0)
        workspace_.watch = [&](const Positions& x) { outcome.moved.emplace_back((x - state.before.x).cast<float>()); };
      const StepReport& report = step(subject_.model(), inputs, after, workspace_, rule);
      workspace_.watch = nullptr;
      outcome.used_ms += report.step_ms;
      if (repeat > 0) {
        add_times(outcome, report);
        continue;
      }
      outcome.label = entries[m].label;
      outcome.failed = report.failed;
      outcome.stop_reason = report.stop_reason;
      outcome.iterations = report.iterations;
      outcome.trials = report.line_search;
      outcome.error_estimate = report.error_estimate;
      outcome.motion_estimate = report.motion_estimate;
      outcome.records = report.records;
      outcome.x = after.x;
      if (report.failed) continue;
      // The sum runs from the last iterate backwards, so that gains near the minimum keep their last digits.
      double left = gained(subject_.model(), inputs, state.before, outcome.x, reference_workspace_);
      outcome.gained.assign(outcome.records.size() + 1, left);
      for (std::size_t k = outcome.records.size(); k-- > 0;) {
        left -= outcome.records[k].decrease;
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

// Puts the subject into a state. Solvers that were prepared for other values of its model are prepared again.
const StepInputs& SolverComparison::put(const BenchState& state) {
  const StepInputs& inputs = subject_.inputs(state);
  if (prepared_for_ != subject_.model().id) {
    prepared_.clear();
    lowest_.emplace(subject_.model());
    prepared_for_ = subject_.model().id;
  }
  return inputs;
}

StepInputs SolverComparison::inputs_of(const BenchState& state, const SolverEntry& entry) {
  StepInputs inputs = put(state);
  inputs.solver.iterations = entry.iterations;
  inputs.solver.rounds = 1;
  inputs.solver.still = 0;
  inputs.solver.history = entry.history;
  inputs.solver.line_search = LineSearch::armijo;
  inputs.solver.chebyshev = entry.chebyshev;
  inputs.solver.matrix = entry.start.matrix;
  inputs.solver.levels = entry.start.levels();
  inputs.solver = settings_of(entry.method, inputs.solver);
  return inputs;
}

Positions SolverComparison::prediction(const BenchState& state) {
  Positions y;
  inertial_prediction(subject_.model(), put(state), state.before, y);
  return y;
}

std::vector<double> SolverComparison::motion_errors(const BenchState& state, const Outcome& outcome,
                                                    const Positions& solved) {
  const Positions y = prediction(state);
  std::vector<double> errors;
  for (const Eigen::MatrixX3f& moved : outcome.moved)
    errors.push_back(motion_error(subject_.model(), state.before.x, y, state.before.x + moved.cast<double>(), solved));
  return errors;
}

Minimum SolverComparison::reference(const BenchState& state, const std::vector<Outcome>& outcomes) {
  const auto better = [](const Outcome& a, const Outcome& b) {
    const double none = -std::numeric_limits<double>::infinity();
    return (a.failed ? none : a.gained.back()) < (b.failed ? none : b.gained.back());
  };
  const Outcome& best = *std::max_element(outcomes.begin(), outcomes.end(), better);
  const StepInputs inputs = put(state);
  return lowest_->minimum(subject_.model(), inputs, state.before, best.failed ? state.before.x : best.x,
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

double time_to(const Outcome& outcome, const std::vector<double>& errors, double tolerance) {
  const auto near = [tolerance](double error) { return error <= tolerance; };
  const auto place = std::find_if(errors.begin(), errors.end(), near) - errors.begin();
  return place < std::ssize(outcome.ms) ? outcome.ms[place] : std::numeric_limits<double>::infinity();
}

ChebyshevSettings trained_chebyshev(SolverComparison& comparison, const BenchState& training, const Method& method) {
  ChebyshevSettings best{10, 0.99};
  double most = -std::numeric_limits<double>::infinity();
  for (const double radius : {0.7, 0.8, 0.9, 0.95, 0.97, 0.98, 0.99, 0.995, 0.999}) {
    SolverEntry entry{"", method, 30};
    entry.chebyshev = {best.delay, radius};
    const Outcome outcome = comparison.run(training, {entry}, 0).front();
    if (outcome.failed || outcome.gained.back() <= most) continue;
    most = outcome.gained.back();
    best.radius = radius;
  }
  return best;
}

void train_chebyshev(SolverComparison& comparison, const BenchState& training, std::vector<SolverEntry>& entries) {
  for (SolverEntry& entry : entries) {
    if (entry.method.acceleration == Acceleration::chebyshev)
      entry.chebyshev = trained_chebyshev(comparison, training, entry.method);
  }
}

}  // namespace supple
