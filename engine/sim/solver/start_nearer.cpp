#include "sim/solver/start_nearer.h"

#include <algorithm>
#include <utility>

#include "sim/solver/place_iterate.h"

namespace supple {

bool is_still(const StepContext& c) {
  const Model& model = c.model;
  const OpenWorkspace& w = c.w;
  constexpr double little = 0.01;  // of the energy of the body's free motion in the step
  double way = 0, free_way = 0;
  for (int v = 0; v < model.free; ++v) {
    way += model.mass[v] * c.state.v.row(v).squaredNorm();
    free_way += model.mass[v] * (w.y.row(v) - c.state.x.row(v)).squaredNorm();
  }
  return model.time_step * model.time_step * way < little * free_way;
}

namespace {

// Makes the trial positions the first iterate where their g is below a share of the current one's. Friction is treated
// as in gain_of_staying() (from_staying.h).
void start_from_trial_below(double share, const StepContext& c) {
  OpenWorkspace& w = c.w;
  const double given = w.current.g - friction_energy(w.current.contacts, w.current.x);
  find_contacts_of(c.model, c.inputs, w, w.trial);
  const double rubbed = friction_energy(w.trial.contacts, w.trial.x);
  evaluate(c.model, w, w.trial, Wanted::gradient);
  if (!(w.trial.g - rubbed < share * given)) return;
  std::swap(w.current, w.trial);
  w.report.objective.back() = w.current.g;
  if (!may_touch(c.inputs)) return;
  forget_counts(w.contact);
  count_contacts(w.trial.contacts, w.current.contacts, w.contact);
}

}  // namespace

void start_without_fall(StepContext& c) {
  const int free = c.model.free;
  OpenWorkspace& w = c.w;
  const TimedPhase timed(w.clock, Phase::evaluate, "start without fall");
  w.trial.x.topRows(free) = (c.state.x + c.model.time_step * c.state.v).topRows(free);
  if (w.turns) w.trial.x.topRows(free) += w.turned;
  start_from_trial_below(1, c);
}

bool touches_between_vertices(const StepContext& c) {
  return std::ranges::any_of(c.w.current.contacts,
                             [](const Contact& contact) { return contact.depth > 0 && !contact.stencil.is_vertex(); });
}

void start_where_it_was(StepContext& c) {
  constexpr double far_better = 0.25;  // share of the current g
  OpenWorkspace& w = c.w;
  const TimedPhase timed(w.clock, Phase::evaluate, "start where it was");
  w.trial.x.topRows(c.model.free) = c.state.x.topRows(c.model.free);
  if (inertial_energy(c.model, w, w.trial.x) < far_better * w.current.g || c.model.energy_may_be_negative)
    start_from_trial_below(far_better, c);
}

}  // namespace supple
