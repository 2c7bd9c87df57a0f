#include "sim/solver/step.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/timing.h"
#include "base/trace.h"
#include "sim/solver/lbfgs.h"
#include "sim/solver/line_search.h"

namespace supple {
namespace {

// What the remaining decreases would add up to if they went on as they did since objective[first]: the numerator of
// equation 12 seen from inside [J]. Decreases of quasi-Newton iterations shrink unevenly, so the ratio is averaged over
// the last three. Too few to tell: as much again as was gained.
double estimate_remaining(const StepReport& report, std::size_t first) {
  const std::vector<double>& g = report.objective;
  const std::size_t steps = g.size() - 1 - first;
  if (steps < 2) return steps == 0 ? 0 : std::max(0.0, g[first] - g[first + 1]);
  const double last = g[g.size() - 2] - g.back();
  const std::size_t back = std::min<std::size_t>(3, steps - 1);
  const double earlier = g[g.size() - 2 - back] - g[g.size() - 1 - back];
  if (last <= 0 || earlier <= 0) return 0;
  const double ratio = std::min(0.95, std::pow(last / earlier, 1.0 / static_cast<double>(back)));
  return last * ratio / (1 - ratio);
}

// The share that is left of all that there was to gain from `start`.
double as_error(double remaining, double gained) {
  return remaining > 0 ? remaining / (std::max(gained, 0.0) + remaining) : 0;
}

int first_bad_vertex(const Model& model, const Positions& x) {
  int worst = 0;
  double furthest = -1;
  for (int v = 0; v < model.vertices; ++v) {
    if (!x.row(v).allFinite()) return model.input_of[v];
    const double away = (x.row(v) - model.rest.row(v)).norm();
    if (away > furthest) {
      furthest = away;
      worst = v;
    }
  }
  return model.input_of[worst];
}

// The objective of a body that flies apart: many times what it takes to move all of it by its own size in one step.
bool absurd(const Model& model, double objective, double start) {
  const double speed = model.size / model.time_step;
  return !std::isfinite(objective) || objective > 1e6 * (0.5 * model.total_mass * speed * speed + std::abs(start));
}

void fail(const Model& model, Workspace& w, const char* phase, const Positions& x, double objective) {
  w.report.failed = true;
  w.report.failure.phase = phase;
  w.report.failure.vertex = first_bad_vertex(model, x);
  w.report.failure.what =
      std::isfinite(objective) ? "the objective has grown beyond all bounds" : "a number is no longer finite";
}

struct Descent {
  bool done = false;
  double slope = 0;
};

// A direction that leads downhill: what the rule says, or what it says once it has forgotten what it learned.
Descent next_direction(const Model& model, const FrameInputs& inputs, Workspace& w, SearchRule& rule) {
  const Zone zone("direction");
  for (;;) {
    const double slope = rule.direction(model, inputs, w);
    if (below_resolution(model, w)) return {true, slope};
    if (slope < 0) return {false, slope};
    if (!rule.forget()) return {true, slope};
  }
}

// The contacts found at the trial point take the place of those that the search went by: in the gradient there, and in
// the objective by what is returned.
double take_contacts(Workspace& w) {
  ContactWork& work = w.contact;
  double jump = 0;
  jump -= add_contacts(work.earlier, work.stick_length, w.trial, nullptr, w.direction, &w.trial_gradient, -1).value;
  jump += add_contacts(work.found, work.stick_length, w.trial, nullptr, w.direction, &w.trial_gradient).value;
  keep_contacts(work);
  return jump;
}

// The iterations of algorithm 1 from x, whose evaluation is at hand.
void iterate(const Model& model, const FrameInputs& inputs, Workspace& w, SearchRule& rule, double enough) {
  const SolverSettings& solver = inputs.solver;
  StepReport& report = w.report;
  Stopwatch watch;
  const std::size_t first = report.objective.size() - 1;
  const double start = report.objective.back();
  double objective = start;
  report.remaining_estimate = 0;
  if (!std::isfinite(objective)) return fail(model, w, "evaluate", w.x, objective);
  rule.begin(model, inputs, w);

  report.stop_reason = StopReason::iterations;
  for (report.iterations = 0; report.iterations < solver.iterations;) {
    watch.lap_ms();
    const Descent descent = next_direction(model, inputs, w, rule);
    report.slope = descent.slope;
    if (!std::isfinite(descent.slope)) return fail(model, w, "solve", w.x, descent.slope);
    if (descent.done || -descent.slope <= enough) {
      report.stop_reason = StopReason::round_off;
      break;
    }
    watch.lap_ms();
    Zone zone("line search");
    Change change{};
    IterationRecord record;
    if (solver.line_search == LineSearch::none) {
      set_trial(model, w, 1);
      change = evaluate(model, w, w.trial, w.trial_energy, &w.trial_gradient, &w.x, &w.energy);
      ++report.line_search;
      if (has_colliders(inputs)) find_contacts_timed(model, inputs, w.trial, w);
    } else {
      Search search = search_line(model, inputs, w, descent.slope, objective, change, record);
      report.evaluate_ms += watch.lap_ms();
      if (search == Search::failed && rule.forget()) {
        const Descent plain = next_direction(model, inputs, w, rule);
        report.slope = plain.slope;
        watch.lap_ms();
        search = plain.done ? Search::exhausted : search_line(model, inputs, w, plain.slope, objective, change, record);
      }
      if (search != Search::found) {
        report.stop_reason = search == Search::exhausted ? StopReason::round_off : StopReason::line_search_failed;
        break;
      }
    }
    report.evaluate_ms += watch.lap_ms();
    zone.next("accept");
    rule.accepted(model, inputs, w);
    if (has_colliders(inputs)) {
      const int changes = w.contact.counts.changes;
      change.value += take_contacts(w);
      if (w.contact.counts.changes != changes) rule.contacts_changed(inputs);
    }
    objective += change.value;
    ++report.iterations;
    report.objective.push_back(objective);
    report.decrease -= change.value;
    if (absurd(model, objective, start)) return fail(model, w, "line search", w.trial, objective);
    w.x.swap(w.trial);
    w.gradient.swap(w.trial_gradient);
    w.energy.swap(w.trial_energy);
    record.decrease = -change.value;
    record.elapsed_ms = w.since_entry.elapsed_ms();
    report.history.push_back(record);
    report.lbfgs_ms += watch.lap_ms();
    report.remaining_estimate = estimate_remaining(report, first);
    if (solver.target_error > 0 && as_error(report.remaining_estimate, report.decrease) < solver.target_error) {
      report.stop_reason = StopReason::target_error;
      break;
    }
  }
}

}  // namespace

void minimize(const Model& model, const FrameInputs& inputs, Workspace& w, double enough) {
  SystemInverse system;
  LbfgsRule rule(system);
  minimize(model, inputs, w, rule, enough);
}

void minimize(const Model& model, const FrameInputs& inputs, Workspace& w, SearchRule& rule, double enough) {
  evaluate_start(model, inputs, w);
  iterate(model, inputs, w, rule, enough);
}

namespace {

void clear(StepReport& report) {
  report.objective.clear();
  report.history.clear();
  std::vector<double> objective = std::move(report.objective);
  std::vector<IterationRecord> history = std::move(report.history);
  report = StepReport{};
  report.objective = std::move(objective);
  report.history = std::move(history);
}

// Where the body was, its handles moved; a body that nothing holds is also carried along with its centre of mass, which
// costs no elastic energy and keeps its momentum.
void set_staying(const Model& model, const FrameInputs& inputs, const State& state, Workspace& w) {
  w.trial.topRows(model.free) = state.x.topRows(model.free);
  if (!model.free_floating || has_colliders(inputs)) return;  // it might be carried into a collider
  Eigen::RowVector3d moved = Eigen::RowVector3d::Zero();
  for (int v = 0; v < model.free; ++v) moved += model.mass[v] * (w.y.row(v) - state.x.row(v));
  moved /= model.total_mass;
  for (int v = 0; v < model.free; ++v) w.trial.row(v) += moved;
}

// The answer must not be worse than staying: g(x) <= g(q) bounds the energy of backward Euler (docs/method.md), not
// that of midpoint, where staying also turns the velocity round. When the iterations from y have not come that far
// (elements turned inside out by a violent step), descend from there instead. Costs an evaluation only when the inertia
// of staying cannot settle it, or when the elastic energy may be negative. Friction only takes energy, so its
// potential, which staying has none of, does not count.
void descend_from_staying(const Model& model, const FrameInputs& inputs, const State& state, Workspace& w,
                          SearchRule& rule) {
  const Zone zone("check staying");
  StepReport& report = w.report;
  const double rubbed = friction_energy(w.contact.found, w.contact.stick_length, w.x);
  const double reached = report.objective.back() - rubbed;
  const double inverse_h2 = model.scheme.inertia / (model.time_step * model.time_step);
  set_staying(model, inputs, state, w);
  double inertia = 0;
  for (int v = 0; v < model.free; ++v)
    inertia += 0.5 * inverse_h2 * model.mass[v] * (w.trial.row(v) - w.y.row(v)).squaredNorm();
  if (reached <= inertia && !model.energy_may_be_negative) return;
  const Stopwatch watch;
  if (has_colliders(inputs)) find_contacts_timed(model, inputs, w.trial, w);
  Change staying = evaluate(model, w, w.trial, w.trial_energy, nullptr, nullptr, nullptr);
  const double rubbed_there = friction_energy(w.contact.found, w.contact.stick_length, w.trial);
  staying.value -= rubbed_there;
  report.evaluate_ms += watch.elapsed_ms();
  if (!(staying.value < reached - noise_of(model, reached, extent_of(model, w)))) {
    if (has_colliders(inputs)) w.contact.found.swap(w.contact.earlier);
    return;
  }
  w.x.swap(w.trial);
  report.decrease += reached + rubbed - staying.value;
  report.history.push_back({w.since_entry.elapsed_ms(), reached + rubbed - staying.value - rubbed_there, 0, {}});
  const int iterations = report.iterations;
  minimize(model, inputs, w, rule);
  report.iterations += iterations;
}

// Backward Euler: (x - q)/h. Midpoint: the velocity whose mean with the old one is that; held vertices just follow.
void set_velocity(const Model& model, const Workspace& w, State& state) {
  const double h = model.time_step;
  if (model.integrator == Integrator::backward_euler) {
    state.v = (w.x - state.x) / h;
    return;
  }
  const int held = model.vertices - model.free;
  state.v.topRows(model.free) = 2 / h * (w.x - state.x).topRows(model.free) - state.v.topRows(model.free);
  state.v.bottomRows(held) = (w.x - state.x).bottomRows(held) / h;
}

void report_contacts(Workspace& w) {
  w.report.contacts = w.contact.counts;
  Positions& force = w.trial_gradient;
  force.setZero();
  add_contacts(w.contact.found, w.contact.stick_length, w.x, nullptr, w.direction, &force, -1);
  w.report.contact_force = force.colwise().sum().transpose();
}

}  // namespace

const StepReport& step(const Model& model, const FrameInputs& inputs, State& state, Workspace& w) {
  SystemInverse system;
  LbfgsRule rule(system);
  return step(model, inputs, state, w, rule);
}

const StepReport& step(const Model& model, const FrameInputs& inputs, State& state, Workspace& w, SearchRule& rule) {
  w.since_entry = Stopwatch();
  const Zone step_zone("step", model.name);
  Zone zone("begin step");
  w.prepare(model, inputs.solver);
  StepReport& report = w.report;
  clear(report);
  begin_step(model, inputs, state, w);
  zone.next("first iterate");
  const double above_start = set_first_iterate(model, inputs, state, w);
  report.start_ms = w.since_entry.elapsed_ms();
  zone.next("iterate");
  iterate(model, inputs, w, rule, 0);
  zone.next("end step");
  if (!report.failed && inputs.solver.line_search != LineSearch::none)
    descend_from_staying(model, inputs, state, w, rule);
  report.error_estimate = as_error(report.remaining_estimate, report.decrease + above_start);
  if (!report.failed && !w.x.allFinite()) fail(model, w, "step", w.x, std::numeric_limits<double>::quiet_NaN());
  if (!report.failed) {
    set_velocity(model, w, state);
    state.x = w.x;
    state.time += model.time_step;
  }
  if (has_colliders(inputs)) report_contacts(w);
  report.step_ms = w.since_entry.elapsed_ms();
  report.other_ms = report.step_ms - report.evaluate_ms - report.solve_ms - report.lbfgs_ms - report.collide_ms;
  return report;
}

}  // namespace supple
