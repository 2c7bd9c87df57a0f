#include "sim/solver/stop_at_impact.h"

#include <algorithm>
#include <utility>

#include "sim/contact/usual_depth.h"
#include "sim/solver/place_iterate.h"
#include "sim/solver/total_momentum.h"

namespace supple {

std::vector<Impact> find_impacts(const StepContext& c) {
  if (!may_touch(c.inputs)) return {};
  const TimedPhase timed(c.w.clock, Phase::collide, "find impact");
  std::vector<Impact> impacts = first_impacts(c.model, c.inputs, c.w.current.x, c.w.contact);
  const bool none = std::ranges::all_of(impacts, [](const Impact& impact) { return impact.share >= 1; });
  return none ? std::vector<Impact>{} : impacts;
}

namespace {

// Moves a part on with the collider that stopped it, where that lowers g. Leaves the better positions in the current
// iterate.
void go_on_with_collider(const StepContext& c, const Part& part, const Impact& impact) {
  const Model& model = c.model;
  const StepInputs& inputs = c.inputs;
  OpenWorkspace& w = c.w;
  find_contacts_of(model, inputs, w, w.current);
  evaluate(model, w, w.current, Wanted::value);
  w.trial.x.topRows(model.free) = w.current.x.topRows(model.free);
  move_rigidly(part, motion_after(inputs, impact.collider, impact.share, part, c.state.x), w.trial.x);
  find_contacts_of(model, inputs, w, w.trial);
  evaluate(model, w, w.trial, Wanted::value);
  if (w.trial.g < w.current.g) std::swap(w.current, w.trial);
}

}  // namespace

void stop_at_impacts(StepContext& c, const std::vector<Impact>& impacts) {
  const TimedPhase timed(c.w.clock, Phase::collide, "stop at impact");
  Positions& x = c.w.current.x;
  const Positions& q = c.state.x;
  for (std::size_t p = 0; p < impacts.size(); ++p) {
    const int first = c.model.parts[p].first_free, free = c.model.parts[p].free;
    if (impacts[p].share < 1)
      x.middleRows(first, free) = q.middleRows(first, free) + impacts[p].share * (x - q).middleRows(first, free);
  }
  const bool by_colliders = std::ranges::any_of(impacts, [](const Impact& impact) { return impact.collider >= 0; });
  if (!by_colliders && is_isolated(c.model, c.w, {})) keep_center(c.model, c.w.y, x);
  for (std::size_t p = 0; p < impacts.size(); ++p) {
    const int collider = impacts[p].collider;
    if (collider >= 0 && c.inputs.collider_motions[collider].moves())
      go_on_with_collider(c, c.model.parts[p], impacts[p]);
  }
  forget_start(c.w);
  c.stopped = true;
}

}  // namespace supple
