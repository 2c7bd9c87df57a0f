#include "sim/solver/place_iterate.h"

#include <algorithm>
#include <cmath>

#include "sim/contact/lagged_friction.h"

namespace supple {

void find_contacts_of(const Model& model, const StepInputs& inputs, OpenWorkspace& w, Iterate& iterate) {
  if (!may_touch(inputs)) return;
  const TimedPhase timed(w.clock, Phase::collide, "find contacts");
  find_contacts(model, inputs, iterate.x, w.threads, w.contact, iterate.contacts);
  iterate.moved = 0;
  iterate.keeps_contacts = false;
}

void find_trial_contacts(const Model& model, const StepInputs& inputs, OpenWorkspace& w) {
  if (w.contact.kept_way == 0) {
    find_contacts_of(model, inputs, w, w.trial);
    // Of cloth, points come and go at each iterate, and eased friction makes its steps no better.
    if (std::ranges::all_of(model.parts, &Part::solid)) ease_friction(w.current.contacts, w.trial.contacts);
    return;
  }
  const double way = std::sqrt((w.trial.x - w.current.x).rowwise().squaredNorm().maxCoeff());
  const double moved = w.current.moved + way;
  if (moved >= w.contact.kept_way) return find_contacts_of(model, inputs, w, w.trial);
  w.trial.moved = moved;
  w.trial.keeps_contacts = true;
}

void set_trial(const Model& model, OpenWorkspace& w, double alpha) {
  w.trial.x.topRows(model.free) = w.current.x.topRows(model.free) + alpha * w.direction;
  if (w.is_bowed) w.trial.x.topRows(model.free) += alpha * alpha * w.bow;
}

void move_rigidly(const Part& part, const Eigen::Isometry3d& motion, Positions& x) {
  for (int v = part.first_free; v < part.first_free + part.free; ++v) x.row(v) = (motion * Vec3(x.row(v))).transpose();
}

void evaluate_start(const Model& model, const StepInputs& inputs, OpenWorkspace& w) {
  const TimedPhase timed(w.clock, Phase::evaluate, "evaluate start");
  if (may_touch(inputs)) {
    w.trial.contacts.swap(w.current.contacts);
    find_contacts_of(model, inputs, w, w.current);
    count_contacts(w.trial.contacts, w.current.contacts, w.contact);
  }
  evaluate(model, w, w.current, Wanted::gradient);
  w.report.objective.push_back(w.current.g);
  w.lengths.begin(model);
}

void forget_start(OpenWorkspace& w) {
  w.report.objective.clear();
  forget_counts(w.contact);
}

}  // namespace supple
