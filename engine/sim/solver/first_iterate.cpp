#include "sim/solver/first_iterate.h"

#include <optional>

#include "base/timing.h"
#include "base/trace.h"

namespace supple {
namespace {

constexpr double deepest_start = 0.004;  // overlap that a first iterate may have, over the body's size

}  // namespace

void find_contacts_timed(const Model& model, const FrameInputs& inputs, const Positions& x, Workspace& w) {
  const Zone zone("find contacts");
  const Stopwatch watch;
  find_contacts(model, inputs, x, w);
  const double ms = watch.elapsed_ms();
  w.report.collide_ms += ms;
  w.report.evaluate_ms -= ms;  // whose stopwatch is running
}

void set_trial(const Model& model, Workspace& w, double alpha) {
  w.trial.topRows(model.free) = w.x.topRows(model.free) + alpha * w.direction;
}

void inertial_prediction(const Model& model, const FrameInputs& inputs, const State& state, Positions& y) {
  const double h = model.time_step;
  y = (state.x + h * state.v).rowwise() + (model.scheme.force * h * h * inputs.gravity).transpose();
}

void begin_step(const Model& model, const FrameInputs& inputs, const State& state, Workspace& w) {
  inertial_prediction(model, inputs, state, w.y);
  w.start = &state.x;
  if (needs_start(model)) w.q = state.x;
  w.contact.found.clear();
  w.contact.earlier.clear();
  if (has_colliders(inputs)) {
    const Zone zone("begin contacts");
    const Stopwatch watch;
    begin_contacts(model, inputs, state.x, w);
    w.report.collide_ms += watch.elapsed_ms();
  }
  w.x = w.y;
  for (std::size_t i = 0; i < model.handled.size(); ++i) {
    const std::int32_t v = model.handled[i].vertex;
    if (v < model.free) {
      w.target.row(v) = model.scheme.theta < 1 ? inputs.middle_targets.row(i) : inputs.targets.row(i);
    } else {
      w.x.row(v) = inputs.targets.row(i);
    }
  }
  if (model.vertices > model.free)
    w.trial.bottomRows(model.vertices - model.free) = w.x.bottomRows(model.vertices - model.free);
}

void evaluate_start(const Model& model, const FrameInputs& inputs, Workspace& w) {
  const Stopwatch watch;
  if (has_colliders(inputs)) {
    find_contacts_timed(model, inputs, w.x, w);
    keep_contacts(w.contact);
  }
  w.report.objective.push_back(evaluate(model, w, w.x, w.energy, &w.gradient, nullptr, nullptr).value);
  w.report.evaluate_ms += watch.elapsed_ms();
}

namespace {

// The first iterate. The paper starts from y; with rows eliminated, y leaves the elements beside a handle torn by all
// that the handle did not do freely (its keyed motion, and the fall that it did not take), often by more than their
// size. So the handles' departure from y is spread into the body by the quadratic model that also gives the directions,
// A_ff d_f = -A_fh d_h: one solve. docs/results.md says what was measured.
// Costs an evaluation more, because y stays the first iterate where it is the better one. Returns g(y), the handles at
// their targets, when the first iterate is another one.
std::optional<double> spread_handles(const Model& model, const FrameInputs& inputs, Workspace& w) {
  if (model.couplings.empty()) return std::nullopt;
  Positions& right = w.gradient;
  right.setZero();
  for (const Model::Coupling& entry : model.couplings) {
    right.row(entry.free) -= entry.value * (w.x.row(entry.held) - w.y.row(entry.held));
  }
  if (right.isZero(0)) return std::nullopt;
  Stopwatch watch;
  Zone zone("solve");
  model.factor.solve(right.data(), w.direction.data(), w.solve_scratch.data());
  w.report.solve_ms += watch.lap_ms();
  zone.next("spread handles");
  if (has_colliders(inputs)) find_contacts_timed(model, inputs, w.x, w);
  const double at_y = evaluate(model, w, w.x, w.energy, nullptr, nullptr, nullptr).value;
  w.report.evaluate_ms += watch.lap_ms();
  set_trial(model, w, 1);
  w.x.swap(w.trial);
  evaluate_start(model, inputs, w);
  if (w.report.objective.back() <= at_y) return at_y;
  w.x.swap(w.trial);
  w.report.objective.clear();
  return std::nullopt;
}

// A first iterate far below a surface would start from torn or inverted elements, or beyond the collider. So the body
// goes only as far as the first impact and a little further. Returns whether it was stopped.
bool stop_at_impact(const Model& model, const FrameInputs& inputs, const State& state, Workspace& w) {
  if (!has_colliders(inputs)) return false;
  const Zone zone("stop at impact");
  const Stopwatch watch;
  const double way = free_way(model, inputs, w.x, deepest_start * model.size, w);
  if (way < 1) w.x.topRows(model.free) = state.x.topRows(model.free) + way * (w.x - state.x).topRows(model.free);
  w.report.collide_ms += watch.elapsed_ms();
  return way < 1;
}

// A body that rests on something, or slides along it, starts better without the fall that y has in it, which would
// leave all that it rests on g h^2 deep in its colliders: from q + h v. Costs an evaluation, and only where something
// touches. Friction as in descend_from_staying.
void start_where_better(const Model& model, const FrameInputs& inputs, const State& state, Workspace& w) {
  if (!has_colliders(inputs) || w.contact.counts.touching == 0) return;
  const Zone zone("start where better");
  const Stopwatch watch;
  const double given = w.report.objective.back() - friction_energy(w.contact.found, w.contact.stick_length, w.x);
  w.trial.topRows(model.free) = (state.x + model.time_step * state.v).topRows(model.free);
  find_contacts_timed(model, inputs, w.trial, w);
  const double rubbed = friction_energy(w.contact.found, w.contact.stick_length, w.trial);
  const double unforced = evaluate(model, w, w.trial, w.trial_energy, &w.trial_gradient, nullptr, nullptr).value;
  if (unforced - rubbed < given) {
    w.report.objective.back() = unforced;
    w.contact.counts = {};
    keep_contacts(w.contact);
    w.x.swap(w.trial);
    w.gradient.swap(w.trial_gradient);
    w.energy.swap(w.trial_energy);
  } else {
    w.contact.found.swap(w.contact.earlier);
  }
  w.report.evaluate_ms += watch.elapsed_ms();
}

}  // namespace

double set_first_iterate(const Model& model, const FrameInputs& inputs, const State& state, Workspace& w) {
  const std::optional<double> at_y = spread_handles(model, inputs, w);
  const bool stopped = stop_at_impact(model, inputs, state, w);
  if (stopped) {
    w.report.objective.clear();
    w.contact.counts = {};
    w.contact.set_before = w.contact.set_now = 0;
  }
  if (stopped || !at_y) evaluate_start(model, inputs, w);
  start_where_better(model, inputs, state, w);
  return at_y && !stopped ? *at_y - w.report.objective.back() : 0;
}

}  // namespace supple
