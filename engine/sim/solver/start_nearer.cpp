#include "sim/solver/start_nearer.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "sim/solver/place_iterate.h"

namespace supple {

namespace {

// Tells whether a part moves so little that the forces on it must be balanced.
bool hangs_still(const StepContext& c, const Part& part) {
  const Model& model = c.model;
  const OpenWorkspace& w = c.w;
  constexpr double little = 0.01;  // of the energy of the part's free motion in the step
  double way = 0, free_way = 0;
  for (int v = part.first_free; v < part.first_free + part.free; ++v) {
    way += model.mass[v] * c.state.v.row(v).squaredNorm();
    free_way += model.mass[v] * (w.y.row(v) - c.state.x.row(v)).squaredNorm();
  }
  return model.time_step * model.time_step * way < little * free_way;
}

bool is_between_vertices(const Contact& contact) { return contact.depth > 0 && !contact.stencil.is_vertex(); }

// Sets the trial iterate to the current one, and calls move(part) for each part that is to be moved there: for the only
// part or, of several, for those with a contact of which counts(contact) is true, and those of which also(part) is
// true.
template <class Counts, class Also, class Move>
void set_trial_by_parts(const StepContext& c, const Counts& counts, const Also& also, const Move& move) {
  const Model& model = c.model;
  if (model.parts.size() == 1) return move(model.parts.front());
  OpenWorkspace& w = c.w;
  w.trial.x.topRows(model.free) = w.current.x.topRows(model.free);
  std::vector<char> is_chosen(model.parts.size(), 0);
  for (const Contact& contact : w.current.contacts) {
    if (!counts(contact)) continue;
    for (int k = 0; k < contact.stencil.count; ++k) is_chosen[model.part_number(contact.stencil.vertex[k])] = 1;
  }
  for (std::size_t p = 0; p < model.parts.size(); ++p) {
    if (is_chosen[p] != 0 || also(model.parts[p])) move(model.parts[p]);
  }
}

}  // namespace

bool hangs_still(const StepContext& c) {
  return std::ranges::any_of(c.model.parts, [&](const Part& part) { return hangs_still(c, part); });
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
  OpenWorkspace& w = c.w;
  const TimedPhase timed(w.clock, Phase::evaluate, "start without fall");
  const auto move = [&](const Part& part) {
    const int first = part.first_free, free = part.free;
    w.trial.x.middleRows(first, free) = (c.state.x + c.model.time_step * c.state.v).middleRows(first, free);
    if (w.turns) w.trial.x.middleRows(first, free) += w.turned.middleRows(first, free);
  };
  set_trial_by_parts(
      c, [](const Contact& contact) { return contact.depth > 0; },
      [&](const Part& part) { return hangs_still(c, part); }, move);
  start_from_trial_below(1, c);
}

bool touches_between_vertices(const StepContext& c) {
  return std::ranges::any_of(c.w.current.contacts, is_between_vertices);
}

void start_where_it_was(StepContext& c) {
  constexpr double far_better = 0.25;  // share of the current g
  OpenWorkspace& w = c.w;
  const TimedPhase timed(w.clock, Phase::evaluate, "start where it was");
  const auto move = [&](const Part& part) {
    w.trial.x.middleRows(part.first_free, part.free) = c.state.x.middleRows(part.first_free, part.free);
  };
  set_trial_by_parts(
      c, is_between_vertices, [](const Part&) { return false; }, move);
  if (w.trial.x == w.current.x) return;  // what did not move before the step starts there already
  if (inertial_energy(c.model, w, w.trial.x) < far_better * w.current.g || energy_may_be_negative(c))
    start_from_trial_below(far_better, c);
}

}  // namespace supple
