// Lists the candidates for the first iterate in the order in which they are tried, each after its guard. The
// declaration of a candidate tells what it cures and what it costs. The first four place the iterate; the last two take
// its place where their g is lower.
#include "sim/solver/first_iterate.h"

#include "sim/solver/leave_prediction.h"
#include "sim/solver/start_nearer.h"
#include "sim/solver/stop_at_impact.h"

namespace supple {

void set_first_iterate(StepContext& c) {
  OpenWorkspace& w = c.w;
  if (leaves_prediction(c)) fit_handles_and_turning(c);
  if (handles_turn_far(c)) turn_with_handles(c);
  if (is_worse_than_prediction(c)) return_to_prediction(c);
  if (const std::vector<Impact> impacts = find_impacts(c); !impacts.empty()) stop_at_impacts(c, impacts);

  const bool is_evaluated = !w.report.objective.empty();
  if (!is_evaluated) evaluate_start(c.model, c.inputs, w);
  const bool touches = may_touch(c.inputs) && w.contact.counts.touching > 0;
  const double from = c.at_prediction.value_or(w.current.g);

  if (touches || hangs_still(c)) start_without_fall(c);
  if (touches && touches_between_vertices(c)) start_where_it_was(c);

  const bool is_known = (c.at_prediction || !touches) && !c.stopped;
  c.above_start = is_known ? from - w.report.objective.back() : 0;
}

}  // namespace supple
