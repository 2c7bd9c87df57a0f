#include "sim/solver/line_search.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/solver/place_iterate.h"
#include "sim/solver/unforeseen_contacts.h"

namespace supple {
namespace {

constexpr int most_halvings = 30;
constexpr int most_refusals = 5;  // refusals of trial points because of the contacts found there
constexpr double round_off = std::numeric_limits<double>::epsilon();

// Applies a form of Armijo's test by slopes, for decreases that are lost in round-off: it does not subtract large
// numbers (Hager and Zhang 2005, "A new conjugate gradient method with guaranteed descent and an efficient line
// search", equation 4.1).
bool decreases_by_slope(const Change& change, double slope, double armijo, double noise) {
  return change.value <= noise && change.slope <= (2 * armijo - 1) * slope;
}

// Finds the contacts at the trial point, which was accepted with the planes of the search. Returns false where they
// make the point worse than where the search began; the search could not know of them. Friction, whose normal forces
// are lagged, does not count here.
bool contacts_accept(const Model& model, const StepInputs& inputs, OpenWorkspace& w, double change, double noise) {
  if (!may_touch(inputs)) return true;
  find_trial_contacts(model, inputs, w);
  if (w.trial.keeps_contacts) return true;
  const double jump = contact_energy(w.trial.contacts, w.trial.x) - contact_energy(w.current.contacts, w.trial.x);
  return jump <= 0 || change + jump <= noise;
}

}  // namespace

// Tries alpha = 1, 1/2, ...
Search search_line(const Model& model, const StepInputs& inputs, OpenWorkspace& w, double slope, bool may_learn,
                   Change& change, IterationRecord& record) {
  const SolverSettings& solver = inputs.solver;
  const bool is_single = w.elements == Precision::single_precision;
  const double noise =
      noise_of(model, w.current.g, extent_of(model, w)) + (is_single ? single_noise_of(model, w.current.elastic) : 0);
  const double end_noise = noise + (w.is_last_iteration ? single_bias_of(model, w.current.elastic) : 0);
  double alpha = 1;
  int refused = 0;
  for (int halving = 0; halving <= most_halvings; ++halving, alpha /= 2) {
    set_trial(model, w, alpha);
    // What a search leaves is evaluated in double precision, and this may be it. Values of both precisions differ by
    // more than those of one, so slopes decide sooner.
    const bool is_end = halving == 0 && is_single && w.is_last_iteration && !w.is_bowed;
    const bool by_slope = -alpha * slope < (is_end ? 10 * end_noise : noise) / solver.armijo;
    // The first trial nearly always succeeds, and its gradient becomes that of the next iterate. After a rejection only
    // the energy decides.
    const bool with_gradient = halving == 0 || by_slope;
    change = is_end ? evaluate_trial_in_double(model, w)
                    : evaluate_trial(model, w, with_gradient ? Wanted::gradient : Wanted::value);
    ++w.report.line_search;
    record.alpha = alpha;
    const bool accepted = by_slope ? decreases_by_slope(change, slope, solver.armijo, is_end ? end_noise : noise)
                                   : change.value <= solver.armijo * alpha * slope;
    if (halving == 0) record.full = {accepted, change.slope / slope};
    if (!accepted || !std::isfinite(change.value)) {
      if (is_end) w.elements = Precision::single_precision;
      const bool is_beyond_range = is_single && !is_end && !std::isfinite(change.value);
      if (is_beyond_range) return Search::failed;  // the range of single precision is small
      // Where slopes are lost in round-off too, shorter steps only repeat the noise. A thousandth of the noise stands
      // for a negligible distance, and a slope below the energy of the positions' last bits is noise itself.
      if (by_slope && -slope < 1e-3 * noise + noise_of(model, 0, extent_of(model, w))) return Search::exhausted;
      continue;
    }
    if (!with_gradient) change = evaluate_trial(model, w, Wanted::gradient);
    if (is_single && by_slope && !w.is_bowed)
      change.value = 0.5 * alpha * (slope + change.slope);  // nearer than values can tell
    if (is_end) change.excess = w.current.g + change.value - w.trial.g;
    if (contacts_accept(model, inputs, w, change.value, noise)) return Search::found;
    if (is_end) w.elements = Precision::single_precision;
    if (refused == 0 && may_learn && learn_contacts(model, inputs, w)) return Search::unforeseen;
    // A shorter step helps against contacts of which the current iterate cannot learn, but not where the energy itself
    // jumps (a vertex that passes an edge).
    if (++refused == most_refusals) return Search::worse;
  }
  return Search::failed;
}

double extent_of(const Model& model, const OpenWorkspace& w) {
  return w.current.x.topRows(model.free).cwiseAbs().maxCoeff();
}

bool below_resolution(const Model& model, const OpenWorkspace& w) {
  const double extent = extent_of(model, w);
  return w.direction.cwiseAbs().maxCoeff() <= 4 * round_off * std::max(extent, model.size);
}

}  // namespace supple
