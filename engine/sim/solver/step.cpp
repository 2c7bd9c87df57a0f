// Makes a step in this order, which step() at the end of this file shows: the prediction y and the targets of handles
// (begin_step), the matrix of directions, the pair of the step before, the first iterate, the iterations, the
// comparison with staying, the estimate of what is left, Newton's method where the step is hard, and the new state. The
// iterations are one search; a step makes a second search where the first ended above staying, and Newton's method is
// one more. The report's iterations and decrease are sums over all searches; its stop reason, slope and decrement are
// those of the last one.
#include "sim/solver/step.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/trace.h"
#include "base/unsolved_step.h"
#include "sim/solver/carried_pair.h"
#include "sim/solver/energy_gain.h"
#include "sim/solver/error_estimate.h"
#include "sim/solver/lbfgs.h"
#include "sim/solver/line_search.h"
#include "sim/solver/matrix_rule.h"
#include "sim/solver/newton_finish.h"

namespace supple {
namespace {

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

// Tells whether an objective is that of a body that flies apart: many times the energy that moves all of the body by
// its own size in one step.
bool absurd(const Model& model, double objective, double start) {
  const double speed = model.size / model.time_step;
  return !std::isfinite(objective) || objective > 1e6 * (0.5 * model.total_mass * speed * speed + std::abs(start));
}

void fail(const Model& model, Workspace& w, const char* phase, double objective) {
  w.report.failed = true;
  w.report.failure.during = phase;
  w.report.failure.vertex = first_bad_vertex(model, w.current.x);
  w.report.failure.what =
      std::isfinite(objective) ? "the objective has grown beyond all bounds" : "a number is no longer finite";
}

struct Descent {
  bool done = false;
  double slope = 0;
};

// Asks the rule for a direction that leads downhill. If it does not, asks again after the rule has forgotten what it
// learned.
Descent next_direction(const Model& model, const StepInputs& inputs, Workspace& w, SearchRule& rule) {
  const TimedPhase timed(w.clock, Phase::other, "direction");
  for (;;) {
    const double slope = w.report.slope = rule.direction(model, inputs, w);
    if (below_resolution(model, w)) return {true, slope};
    if (slope < 0) return {false, slope};
    if (!rule.forget()) return {true, slope};
  }
}

// Searches along the direction for the next iterate, and leaves it in the trial iterate. A search that meets contacts
// which it did not foresee is repeated, a few times, along a direction that knows them: adding constraints where an
// iterate violates them, and solving again, is the exchange method of semi-infinite programs (Hettich and Kortanek
// 1993). A search that fails is repeated once along the direction of a rule that has forgotten what it learned.
Search find_next(const Model& model, const StepInputs& inputs, Workspace& w, SearchRule& rule, double slope,
                 Change& change, IterationRecord& record) {
  const TimedPhase timed(w.clock, Phase::evaluate, "line search");
  if (inputs.solver.line_search == LineSearch::none) {
    set_trial(model, w, 1);
    change = evaluate_trial(model, w, rule.needs_gradient() ? Wanted::gradient : Wanted::value);
    ++w.report.line_search;
    find_contacts_of(model, inputs, w, w.trial);
    return Search::found;
  }
  constexpr int most_lessons = 3;
  int lessons = 0;
  for (;;) {
    const Search search = search_line(model, inputs, w, slope, lessons < most_lessons, change, record);
    if (search == Search::unforeseen) {
      ++lessons;
      rule.contacts_changed(inputs);
    } else if (search == Search::failed && rule.forget()) {
      lessons = most_lessons;
    } else {
      return search;
    }
    const Descent again = next_direction(model, inputs, w, rule);
    if (again.done) return Search::exhausted;
    slope = again.slope;
  }
}

// Replaces the contacts that the search used with those found at the trial point. Corrects the trial's gradient;
// returns the change of its objective [J].
double take_contacts(Workspace& w) {
  const double stick = w.contact.stick_length;
  Iterate& to = w.trial;
  double jump = 0;
  jump -= add_contacts(w.current.contacts, stick, to.x, nullptr, w.direction, &to.gradient, -1).value;
  jump += add_contacts(to.contacts, stick, to.x, nullptr, w.direction, &to.gradient).value;
  count_contacts(w.current.contacts, to.contacts, w.contact);
  return jump;
}

// Makes the trial iterate the current one. before: g where the iteration began, without contacts learned since [J].
void accept(const Model& model, const StepInputs& inputs, Workspace& w, SearchRule& rule, double before, Change change,
            IterationRecord& record) {
  const TimedPhase timed(w.clock, Phase::lbfgs, "accept");
  rule.accepted(model, inputs, w);
  if (has_colliders(inputs)) {
    const int changes = w.contact.counts.changes;
    change.value += take_contacts(w);
    if (w.contact.counts.changes != changes) rule.contacts_changed(inputs);
  }
  const double learned = w.current.g - before;
  w.trial.g = w.current.g + change.value;
  std::swap(w.current, w.trial);
  ++w.report.iterations;
  w.report.objective.push_back(w.current.g);
  w.report.decrease -= change.value;
  record.decrease = -change.value - learned;
  record.elapsed_ms = w.clock.elapsed_ms();
  w.report.records.push_back(record);
}

// Tells what a step began with.
struct Origin {
  const State& state;
  double above_start;   // g(y) - g of its first iterate, where that is known [J]
  bool newton_follows;  // where the iterations come to nothing
};

// Tells whether the step, left as it is, would gain energy from nothing. This costs an evaluation, so only steps are
// examined whose iterations had a hard time, or whose gradient leaves it possible while there was still much to gain.
bool gains_energy(const Model& model, const StepInputs& inputs, const Origin& origin, Workspace& w, bool has_gradient) {
  constexpr double much = 0.01;  // of the energies that were exchanged
  const StepReport& report = w.report;
  const bool hard = report.line_search > 2 * report.iterations;
  const bool unsolved = -report.slope > 1e-4 * (report.decrease + origin.above_start);  // of the last direction
  if (!hard && !(unsolved && has_gradient && may_gain_energy(model, inputs, origin.state, w, much))) return false;
  const TimedPhase timed(w.clock, Phase::evaluate, "check energy");
  return share_from_nothing(model, inputs, origin.state, w) > much;
}

// Ends the iterations of a step's search where a budget of time asks for it, and notes their number in the report, so
// that a later run can end there without a clock.
class TimeBudget {
 public:
  enum Which { from_first_iterate, from_staying };
  TimeBudget(const StepInputs& inputs, Workspace& w, Which search)
      : limit_ms_(inputs.solver.budget_ms), clock_(w.clock), cut_(w.report.cuts.after[search]) {
    if (inputs.repeated_cuts) repeated_ = inputs.repeated_cuts->after[search];
    if (limit_ms_ > 0) last_ms_ = clock_.elapsed_ms();
  }

  // Tells whether no further iteration fits, after `iterations` of them. One that takes as long as the longest so far
  // is expected; the first one is always made.
  bool is_spent(int iterations) {
    const bool spent = repeated_ ? iterations == *repeated_ : limit_ms_ > 0 && iterations > 0 && would_end_late();
    if (spent) cut_ = iterations;
    return spent;
  }

 private:
  bool would_end_late() {
    const double now = clock_.elapsed_ms();
    longest_ms_ = std::max(longest_ms_, now - std::exchange(last_ms_, now));
    return now + longest_ms_ > limit_ms_;
  }

  double limit_ms_, last_ms_ = 0, longest_ms_ = 0;
  const StepClock& clock_;
  int& cut_;
  std::optional<int> repeated_;  // -1 where the earlier run's search was not ended
};

// Tells where a search ends at the latest.
struct Limits {
  int iterations;
  int iterations_of_rounds;      // where the answer so far gains energy from nothing
  double enough = 0;             // a direction that promises less ends the search, -tr(grad^T d) [J]
  TimeBudget* budget = nullptr;  // null: time has no bound
  bool newton_follows = false;   // the search ends where it tries too many points: Newton's method does better there
  bool finishing = false;        // it makes one iteration at least, and ends where contacts make the next iterate worse
};

// Runs the iterations of algorithm 1 from the current iterate, which has been evaluated. origin: of the step that the
// search begins; null for other searches, which make no more rounds. Returns whether it gave up because of its trials.
bool run_iterations(const Model& model, const StepInputs& inputs, Workspace& w, SearchRule& rule, const Limits& limits,
                    const Origin* origin = nullptr) {
  const SolverSettings& solver = inputs.solver;
  StepReport& report = w.report;
  const std::size_t first = report.objective.size() - 1;
  const double start = w.current.g;
  report.remaining_estimate = 0;
  if (!std::isfinite(start)) {
    fail(model, w, "evaluate", start);
    return false;
  }
  rule.begin(model, inputs, w);

  report.stop_reason = StopReason::iterations;
  report.decrement = 0;
  report.iterations = 0;
  const double above_start = origin != nullptr ? origin->above_start : 0;
  Decrements decrements;
  const int tried = report.line_search;
  bool hopeless = false;
  for (int most = limits.iterations;;) {
    const bool late = limits.budget != nullptr && limits.budget->is_spent(report.iterations);
    hopeless = limits.newton_follows && is_unsolved(0, most, report.line_search - tried);
    bool spent = late || hopeless || report.iterations >= most;
    if (late) report.stop_reason = StopReason::budget;
    if (spent && !late && !hopeless && origin != nullptr && most < limits.iterations_of_rounds &&
        gains_energy(model, inputs, *origin, w, rule.needs_gradient())) {
      most += solver.iterations;
      spent = false;
    }
    if (spent && !rule.measures_last_iterate()) break;
    const Descent descent = next_direction(model, inputs, w, rule);
    if (!std::isfinite(descent.slope)) {
      fail(model, w, "solve", descent.slope);
      break;
    }
    report.decrement = descent.done ? 0 : -0.5 * descent.slope;
    if (rule.measures_last_iterate()) report.remaining_estimate = decrements.left(2 * report.decrement);
    const bool has_enough = -descent.slope <= limits.enough && !(limits.finishing && report.iterations == 0);
    if (descent.done || has_enough) {
      report.stop_reason = StopReason::round_off;
      break;
    }
    if (spent) break;
    if (rule.measures_last_iterate() && is_near_enough(report, solver, above_start)) {
      report.stop_reason = StopReason::target_error;
      break;
    }
    Change change{};
    IterationRecord record;
    const double before = w.current.g;
    const Search search = find_next(model, inputs, w, rule, descent.slope, change, record);
    if (search != Search::found && (search != Search::worse || limits.finishing)) {
      // A first search that finds nothing above round-off leaves nothing to gain, and nothing to compare it with.
      if (search == Search::exhausted && report.iterations == 0) report.remaining_estimate = 0;
      report.stop_reason = search == Search::exhausted ? StopReason::round_off : StopReason::line_search_failed;
      break;
    }
    accept(model, inputs, w, rule, before, change, record);
    decrements.add(-descent.slope, record.decrease);
    if (absurd(model, w.current.g, start)) {
      fail(model, w, "line search", w.current.g);
      break;
    }
    if (rule.measures_last_iterate()) continue;
    report.remaining_estimate = left_by_decreases(report.objective, first);
    if (is_near_enough(report, solver, above_start)) {
      report.stop_reason = StopReason::target_error;
      break;
    }
  }
  return hopeless;
}

}  // namespace

void minimize(const Model& model, const StepInputs& inputs, Workspace& w, double enough) {
  SystemInverse system;
  LbfgsRule rule(system);
  minimize(model, inputs, w, rule, enough);
}

void minimize(const Model& model, const StepInputs& inputs, Workspace& w, SearchRule& rule, double enough) {
  evaluate_start(model, inputs, w);
  run_iterations(model, inputs, w, rule, {inputs.solver.iterations, 0, enough});
}

namespace {

void clear(StepReport& report) {
  report.objective.clear();
  report.records.clear();
  std::vector<double> objective = std::move(report.objective);
  std::vector<IterationRecord> records = std::move(report.records);
  std::vector<Vec3> forces = std::move(report.collider_forces);
  forces.clear();
  report = StepReport{};
  report.objective = std::move(objective);
  report.records = std::move(records);
  report.collider_forces = std::move(forces);
}

// Sets the trial iterate to where the body was, with its handles moved. A body that nothing holds is also carried along
// with its centre of mass, which costs no elastic energy and keeps its momentum. Among colliders it stays as seen from
// the one that it touches most.
void set_staying(const Model& model, const StepInputs& inputs, const State& state, Workspace& w) {
  Positions& x = w.trial.x;
  x.topRows(model.free) = state.x.topRows(model.free);
  if (has_colliders(inputs)) {
    const int collider = most_touched(w.current.contacts, inputs.colliders->size());
    if (collider >= 0 && inputs.collider_motions[collider].moves())
      move_rigidly(model, motion_after(inputs, collider, 0), x);
    return;
  }
  if (!model.free_floating) return;
  Eigen::RowVector3d moved = Eigen::RowVector3d::Zero();
  for (int v = 0; v < model.free; ++v) moved += model.mass[v] * (w.y.row(v) - state.x.row(v));
  moved /= model.total_mass;
  for (int v = 0; v < model.free; ++v) x.row(v) += moved;
}

// The result must not be worse than staying: g(x) <= g(q) bounds the energy of backward Euler (docs/method.md), not
// that of midpoint, where the velocity of a body that stays is reversed. Where the iterations ended higher (because a
// violent step inverted elements), descends from there instead. This costs an evaluation only when the inertia of
// staying cannot decide it, or when the elastic energy may be negative. Friction only takes energy, so its potential is
// left out on both sides. Returns whether these iterations gave up.
//
// A body at rest is nearer to its minimum where it stays than ten iterations come from y. It ends there, unless more
// than a small share of what the step has gained is left: without that it would pay for twice the iterations.
bool descend_from_staying(const Model& model, const StepInputs& inputs, const Origin& origin, Workspace& w,
                          SearchRule& rule) {
  constexpr double small_share = 1e-7;
  const TimedPhase timed(w.clock, Phase::evaluate, "check staying");
  StepReport& report = w.report;
  const double stick = w.contact.stick_length;
  const double friction_reached = friction_energy(w.current.contacts, stick, w.current.x);
  const double reached = w.current.g - friction_reached;
  const double inverse_h2 = model.scheme.inertia / (model.time_step * model.time_step);
  set_staying(model, inputs, origin.state, w);
  double inertia = 0;
  for (int v = 0; v < model.free; ++v)
    inertia += 0.5 * inverse_h2 * model.mass[v] * (w.trial.x.row(v) - w.y.row(v)).squaredNorm();
  if (reached <= inertia && !model.energy_may_be_negative) return false;
  find_contacts_of(model, inputs, w, w.trial);
  evaluate(model, w, w.trial, Wanted::value);
  const double friction_staying = friction_energy(w.trial.contacts, stick, w.trial.x);
  const double staying = w.trial.g - friction_staying;
  if (!(staying < reached - noise_of(model, reached, extent_of(model, w)))) return false;
  std::swap(w.current, w.trial);
  const double gained = reached + friction_reached - staying - friction_staying;
  report.decrease += gained;
  report.records.push_back({w.clock.elapsed_ms(), gained, 0, {}});
  const int iterations = report.iterations;
  evaluate_start(model, inputs, w);
  TimeBudget budget(inputs, w, TimeBudget::from_staying);
  const double enough = small_share * std::max(0.0, report.decrease + origin.above_start);
  const bool hopeless =
      run_iterations(model, inputs, w, rule, {inputs.solver.iterations, 0, enough, &budget, origin.newton_follows});
  report.iterations += iterations;
  return hopeless;
}

// Goes on by Newton's method where the iterations of a step gave up (hopeless), left it far from its minimum, or gained
// energy from nothing, until a direction promises next to nothing of what the step has gained, but never uphill.
void finish_by_newton(const Model& model, const StepInputs& inputs, const Origin& origin, Workspace& w, bool hopeless) {
  constexpr double small_share = 1e-4, smaller_share = 1e-8;  // energy from nothing needs few of them
  StepReport& report = w.report;
  const bool gains = gains_energy(model, inputs, origin, w, true);
  if (!gains && !hopeless && !is_unsolved(report.error_estimate, report.iterations, report.line_search)) return;
  const double gained = gained_in_all(model, inputs, w, report.decrease + origin.above_start);
  const double left = report.remaining_estimate;
  const int iterations = report.iterations;
  ++w.carrying.searches;
  NewtonFinish newton;
  Limits limits{(inputs.solver.rounds - 1) * inputs.solver.iterations, 0,
                (gains ? smaller_share : small_share) * gained};
  limits.finishing = true;
  run_iterations(model, inputs, w, newton, limits);
  report.newton_iterations = report.iterations;
  report.iterations += iterations;
  if (!(report.slope < 0)) {
    report.remaining_estimate = left;  // there was no direction downhill
  } else if (report.stop_reason == StopReason::iterations) {
    report.remaining_estimate = std::max(report.remaining_estimate, report.decrement);
  } else if (report.stop_reason != StopReason::target_error) {
    report.remaining_estimate = report.decrement;
  }
  report.error_estimate = error_at_end(model, inputs, w, report.decrease + origin.above_start);
}

// Sets the new velocity. For backward Euler it is v = (x - q)/h. For midpoint it is the velocity whose mean with the
// old one is (x - q)/h; vertices that are held get (x - q)/h itself.
void set_velocity(const Model& model, const Positions& x, State& state) {
  const double h = model.time_step;
  if (model.integrator == Integrator::backward_euler) {
    state.v = (x - state.x) / h;
    return;
  }
  const int held = model.vertices - model.free;
  state.v.topRows(model.free) = 2 / h * (x - state.x).topRows(model.free) - state.v.topRows(model.free);
  state.v.bottomRows(held) = (x - state.x).bottomRows(held) / h;
}

void report_contacts(const StepInputs& inputs, Workspace& w) {
  w.report.collider_forces.resize(inputs.colliders->size(), Vec3::Zero());
  add_forces(w.current.contacts, w.contact.stick_length, w.current.x, w.report.collider_forces);
  w.report.contacts = w.contact.counts;
  Positions& force = w.scratch;
  force.setZero();
  add_contacts(w.current.contacts, w.contact.stick_length, w.current.x, nullptr, w.direction, &force, -1);
  w.report.contact_force = force.colwise().sum().transpose();
}

void report_times(Workspace& w) {
  w.clock.change(Phase::other);
  StepReport& report = w.report;
  report.evaluate_ms = w.clock.spent_ms(Phase::evaluate);
  report.solve_ms = w.clock.spent_ms(Phase::solve);
  report.lbfgs_ms = w.clock.spent_ms(Phase::lbfgs);
  report.collide_ms = w.clock.spent_ms(Phase::collide);
  report.matrix_ms = w.clock.spent_ms(Phase::matrix);
  report.other_ms = w.clock.spent_ms(Phase::other);
  report.step_ms =
      report.evaluate_ms + report.solve_ms + report.lbfgs_ms + report.collide_ms + report.matrix_ms + report.other_ms;
}

}  // namespace

const StepReport& step(const Model& model, const StepInputs& inputs, State& state, Workspace& w) {
  SystemInverse system;
  LbfgsRule rule(system);
  return step(model, inputs, state, w, rule);
}

const StepReport& step(const Model& model, const StepInputs& inputs, State& state, Workspace& w, SearchRule& rule) {
  w.clock.start();
  const Zone step_zone("step", model.name);
  Zone zone("begin step");
  w.prepare(model, inputs.solver);
  StepReport& report = w.report;
  clear(report);
  begin_step(model, inputs, state, w);
  choose_matrix(model, inputs, state, w);
  choose_carried_pair(model, inputs.solver, state, w);
  zone.next("first iterate");
  const double above_start = set_first_iterate(model, inputs, state, w);
  choose_hessian(model, inputs, state, w);
  report.start_ms = w.clock.elapsed_ms();
  zone.next("iterate");
  TimeBudget budget(inputs, w, TimeBudget::from_first_iterate);
  const Origin origin{state, above_start, may_finish_by_newton(model, inputs)};
  bool hopeless = run_iterations(
      model, inputs, w, rule,
      {inputs.solver.iterations, inputs.solver.rounds * inputs.solver.iterations, 0, &budget, origin.newton_follows},
      &origin);
  zone.next("end step");
  if (!report.failed && inputs.solver.line_search != LineSearch::none)
    hopeless |= descend_from_staying(model, inputs, origin, w, rule);
  report.error_estimate = error_at_end(model, inputs, w, report.decrease + above_start);
  if (origin.newton_follows && !report.failed) finish_by_newton(model, inputs, origin, w, hopeless);
  const Positions& x = w.current.x;
  if (!report.failed && !x.allFinite()) fail(model, w, "step", std::numeric_limits<double>::quiet_NaN());
  if (!report.failed) {
    remember_matrix(model, inputs.solver, w, state);
    remember_carried_pair(w, state);
    set_velocity(model, x, state);
    state.x = x;
    state.time += model.time_step;
  }
  if (has_colliders(inputs)) report_contacts(inputs, w);
  report_times(w);
  return report;
}

}  // namespace supple
