// Makes a step in this order, which step() at the end of this file shows: the prediction y and the targets of handles
// (begin_step), the matrix of directions, the first iterate, the iterations, the
// comparison with staying, the estimate of what is left, Newton's method where the step is hard, and the new state. The
// iterations are one search; a step makes a second search where the first ended above staying, and Newton's method is
// one more. The report's iterations and decrease are sums over all searches; its stop reason, slope and decrement are
// those of the last one.
#include "sim/solver/step.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "base/trace.h"
#include "sim/solver/error_estimate.h"
#include "sim/solver/iterations.h"
#include "sim/solver/lbfgs.h"
#include "sim/solver/line_search.h"
#include "sim/solver/matrix_rule.h"
#include "sim/solver/newton_finish.h"

namespace supple {
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
  set_staying(model, inputs, origin.state, w);
  if (reached <= inertial_energy(model, w, w.trial.x) && !model.energy_may_be_negative) return false;
  find_contacts_of(model, inputs, w, w.trial);
  evaluate(model, w, w.trial, Wanted::value);
  const double friction_staying = friction_energy(w.trial.contacts, stick, w.trial.x);
  const double staying = w.trial.g - friction_staying;
  if (!(staying < reached - noise_of(model, reached, extent_of(model, w)))) return false;
  std::swap(w.current, w.trial);
  const double gained = reached + friction_reached - staying - friction_staying;
  report.decrease += gained;
  report.records.push_back({w.clock.elapsed_ms(), gained, 0, {}});
  if (w.watch) w.watch(w.current.x);
  const int iterations = report.iterations;
  evaluate_start(model, inputs, w);
  TimeBudget budget(inputs, w, TimeBudget::from_staying);
  const double enough = small_share * std::max(0.0, report.decrease + origin.above_start);
  const bool hopeless = run_iterations(model, inputs, w, rule,
                                       {inputs.solver.iterations, 0, enough, &budget, origin.newton_follows}, &origin);
  report.iterations += iterations;
  return hopeless;
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
  zone.next("first iterate");
  const double above_start = set_first_iterate(model, inputs, state, w);
  choose_hessian(model, inputs, state, w);
  report.start_ms = w.clock.elapsed_ms();
  if (w.watch) w.watch(w.current.x);
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
  report.motion_estimate = motion_estimate(model, inputs, state.x, w);
  if (origin.newton_follows && !report.failed && finish_by_newton(model, inputs, origin, w, hopeless)) {
    // Newton's method that ran out of iterations does not know how far it still was.
    const double before = report.stop_reason == StopReason::iterations ? report.motion_estimate : 0;
    report.motion_estimate = std::max(before, motion_estimate(model, inputs, state.x, w));
  }
  const Positions& x = w.current.x;
  if (!report.failed && !x.allFinite()) fail(model, w, "step", std::numeric_limits<double>::quiet_NaN());
  if (!report.failed) {
    remember_matrix(model, inputs.solver, w, state);
    set_velocity(model, x, state);
    state.x = x;
    state.time += model.time_step;
  }
  if (has_colliders(inputs)) report_contacts(inputs, w);
  report_times(w);
  return report;
}

}  // namespace supple
