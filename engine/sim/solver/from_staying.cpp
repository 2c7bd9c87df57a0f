#include "sim/solver/from_staying.h"

#include <algorithm>
#include <utility>

#include "sim/solver/element_precision.h"
#include "sim/solver/iterations.h"
#include "sim/solver/line_search.h"
#include "sim/solver/newton_finish.h"
#include "sim/solver/place_iterate.h"

namespace supple {
namespace {

// A body at rest is nearer to its minimum where it stays than ten iterations come from y. Its second search ends where
// the body stays, unless more than this share of the step's gain is left; otherwise such a body would pay for twice the
// iterations.
constexpr double small_share = 1e-7;

// Sets the trial iterate to where the body was, with its handles moved. A body that nothing holds is also carried along
// with its centre of mass, which costs no elastic energy and keeps its momentum. Among colliders it stays as seen from
// the one that it touches most.
void set_staying(const StepContext& c) {
  const Model& model = c.model;
  const Positions& q = c.state.x;
  OpenWorkspace& w = c.w;
  Positions& x = w.trial.x;
  x.topRows(model.free) = q.topRows(model.free);
  if (has_colliders(c.inputs)) {
    for (const Part& part : model.parts) {
      const int collider = most_touched(model, part, w.current.contacts, c.inputs.colliders->size());
      if (collider >= 0 && c.inputs.collider_motions[collider].moves())
        move_rigidly(part, motion_after(c.inputs, collider, 0, part, q), x);
    }
    return;
  }
  for (const Part& part : model.parts) {
    if (!part.floats) continue;
    const int end = part.first_free + part.free;
    Eigen::RowVector3d moved = Eigen::RowVector3d::Zero();
    for (int v = part.first_free; v < end; ++v) moved += model.mass[v] * (w.y.row(v) - q.row(v));
    moved /= part.mass;
    for (int v = part.first_free; v < end; ++v) x.row(v) += moved;
  }
}

}  // namespace

std::optional<double> gain_of_staying(const StepContext& c) {
  if (c.w.report.failed || c.inputs.solver.line_search == LineSearch::none) return std::nullopt;
  OpenWorkspace& w = c.w;
  const TimedPhase timed(w.clock, Phase::evaluate, "check staying");
  const double friction_reached = friction_energy(w.current.contacts, w.current.x);
  const double reached = w.current.g - friction_reached;
  set_staying(c);
  if (w.trial.x == w.current.x) return std::nullopt;  // it stays as it is
  if (reached <= inertial_energy(c.model, w, w.trial.x) && !energy_may_be_negative(c)) return std::nullopt;
  find_contacts_of(c.model, c.inputs, w, w.trial);
  const double friction_staying = friction_energy(w.trial.contacts, w.trial.x);
  // Mostly staying is far worse, and single precision tells so.
  if (may_begin_in_single(c)) {
    w.elements = Precision::single_precision;
    evaluate(c.model, w, w.trial, Wanted::value);
    w.elements = Precision::double_precision;
    if (w.trial.g - friction_staying > reached + single_noise_of(c.model, w.trial.elastic)) return std::nullopt;
  }
  evaluate(c.model, w, w.trial, Wanted::value);
  const double staying = w.trial.g - friction_staying;
  if (!(staying < reached - noise_of(c.model, reached, extent_of(c.model, w)))) return std::nullopt;
  return reached + friction_reached - staying - friction_staying;
}

void descend_from_staying(StepContext& c, double gain) {
  OpenWorkspace& w = c.w;
  const SolverSettings& solver = c.inputs.solver;
  const TimedPhase timed(w.clock, Phase::evaluate, "descend from staying");
  StepReport& report = w.report;
  std::swap(w.current, w.trial);
  report.decrease += gain;
  report.records.push_back({w.clock.elapsed_ms(), gain, 0, {}});
  if (w.watch) w.watch(w.current.x);
  const int iterations = report.iterations;
  evaluate_start(c.model, c.inputs, w);
  TimeBudget budget(c.inputs, w, TimeBudget::from_staying);
  const SearchLimits limits = {.iterations = solver.iterations,
                               .trials = trials_before_newton(c, solver.iterations),
                               .enough = small_share * std::max(0.0, report.decrease + c.above_start),
                               .budget = &budget};
  const SearchEnd end = run_search(c.model, c.inputs, w, c.rule, limits, origin_of(c));
  c.gave_up |= end == SearchEnd::trials;
  report.iterations += iterations;
}

}  // namespace supple
