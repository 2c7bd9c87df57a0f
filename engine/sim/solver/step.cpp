// Makes a step: this file shows what is tried in which order, and when. step(), at the end of the file, begins with the
// prediction y and the targets of handles (begin_step), chooses the matrix of directions (matrix_rule.h) and the first
// iterate (its candidates are listed in first_iterate.cpp), makes the searches (make_searches), and takes the answer
// into the state. The report's iterations and decrease are sums over all searches; its stop reason, slope and decrement
// are those of the last one.
#include "sim/solver/step.h"

#include <limits>
#include <optional>
#include <utility>

#include "base/trace.h"
#include "sim/solver/element_precision.h"
#include "sim/solver/error_estimate.h"
#include "sim/solver/first_iterate.h"
#include "sim/solver/from_staying.h"
#include "sim/solver/further_iterations.h"
#include "sim/solver/iterations.h"
#include "sim/solver/lbfgs.h"
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

void report_contacts(const StepInputs& inputs, OpenWorkspace& w) {
  w.report.collider_forces.resize(collider_count(inputs), Vec3::Zero());
  add_forces(w.current.contacts, w.current.x, w.report.collider_forces);
  w.report.contacts = w.contact.counts;
  Positions& force = w.scratch;
  force.setZero();
  add_contacts(w.current.contacts, w.current.x, nullptr, w.direction, &force, -1);
  w.report.contact_force = force.colwise().sum().transpose();
}

void report_times(OpenWorkspace& w) {
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

// Estimates how far the step is from its minimum, by its last directions.
void estimate_errors(const StepContext& c) {
  StepReport& report = c.w.report;
  report.error_estimate = error_at_end(c.model, c.inputs, c.w, report.decrease + c.above_start);
  report_motion_estimates(c.model, c.inputs, c.state.x, c.w);
}

// Makes the first search, from the first iterate, with its further iterations.
void iterate(StepContext& c) {
  TimeBudget budget(c.inputs, c.w, TimeBudget::from_first_iterate);
  const int iterations = c.inputs.solver.iterations;
  SearchLimits limits = {.iterations = iterations,
                         .trials = trials_before_newton(c, iterations),
                         .budget = &budget,
                         .begins_in_single = may_begin_in_single(c)};
  Iterations search(c.model, c.inputs, c.w, c.rule, origin_of(c));
  search.run(limits);
  while (const int more = further_iterations(c, search, limits)) search.run(limits = with_more(c, limits, more));
  search.look_further(limits);
  c.gave_up = search.end() == SearchEnd::trials;
}

// Lists the searches of a step in the order in which they are made, each after its guard. The declaration of a search
// tells what it cures, and what its guard costs where it says no.
void make_searches(StepContext& c) {
  iterate(c);
  if (const std::optional<double> gain = gain_of_staying(c)) descend_from_staying(c, *gain);
  estimate_errors(c);
  if (const Hardness hardness = hardness_of(c); hardness != Hardness::none) finish_by_newton(c, hardness);
}

// Changes the state to that at the end of the step.
void take_answer(const StepContext& c, State& state) {
  remember_matrix(c.model, c.inputs.solver, c.w, state.memory);
  state.memory.began_in_single = c.w.began_in_single;
  set_velocity(c.model, c.w.current.x, state);
  state.x = c.w.current.x;
  state.time += c.model.time_step;
}

}  // namespace

const StepReport& step(const Model& model, const StepInputs& inputs, State& state, OpenWorkspace& w) {
  SystemInverse system;
  LbfgsRule rule(system);
  return step(model, inputs, state, w, rule);
}

const StepReport& step(const Model& model, const StepInputs& inputs, State& state, OpenWorkspace& w, SearchRule& rule) {
  w.clock.start();
  const Zone step_zone("step", model.name);
  Zone zone("begin step");
  w.prepare(model, inputs.solver);
  StepReport& report = w.report;
  clear(report);
  StepContext c{model, inputs, state, w, rule};
  begin_step(model, inputs, state, w);
  choose_matrix(model, inputs, state, w);
  zone.next("first iterate");
  expect_precision(c);
  set_first_iterate(c);
  choose_turned_hessian(model, inputs, state, w);
  report.start_ms = w.clock.elapsed_ms();
  if (w.watch) w.watch(w.current.x);
  zone.next("iterate");
  make_searches(c);
  zone.next("end step");
  w.elements = Precision::double_precision;
  if (!report.failed && !w.current.x.allFinite()) fail(model, w, "step", std::numeric_limits<double>::quiet_NaN());
  if (!report.failed) take_answer(c, state);
  if (may_touch(inputs)) report_contacts(inputs, w);
  report_times(w);
  return report;
}

}  // namespace supple
