#include "sim/solver/stop_at_impact.h"

#include <utility>

#include "sim/contact/usual_depth.h"
#include "sim/solver/place_iterate.h"

namespace supple {

Impact find_impact(const StepContext& c) {
  if (!has_colliders(c.inputs)) return {};
  const TimedPhase timed(c.w.clock, Phase::collide, "find impact");
  return first_impact(c.model, c.inputs, c.w.current.x, c.w.contact);
}

namespace {

// Moves the body on with the collider that stopped it, where that lowers g. Leaves the better positions in the current
// iterate.
void go_on_with_collider(const StepContext& c, const Impact& impact) {
  const Model& model = c.model;
  const StepInputs& inputs = c.inputs;
  OpenWorkspace& w = c.w;
  find_contacts_of(model, inputs, w, w.current);
  evaluate(model, w, w.current, Wanted::value);
  w.trial.x.topRows(model.free) = w.current.x.topRows(model.free);
  move_rigidly(model, motion_after(inputs, impact.collider, impact.share), w.trial.x);
  find_contacts_of(model, inputs, w, w.trial);
  evaluate(model, w, w.trial, Wanted::value);
  if (w.trial.g < w.current.g) std::swap(w.current, w.trial);
}

}  // namespace

void stop_at_impact(StepContext& c, const Impact& impact) {
  const TimedPhase timed(c.w.clock, Phase::collide, "stop at impact");
  const int free = c.model.free;
  Positions& x = c.w.current.x;
  const Positions& q = c.state.x;
  x.topRows(free) = q.topRows(free) + impact.share * (x - q).topRows(free);
  if (c.inputs.collider_motions[impact.collider].moves()) go_on_with_collider(c, impact);
  forget_start(c.w);
  c.stopped = true;
}

}  // namespace supple
