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
constexpr double curvature_share =
    0.9;  // gamma_2 of the strong Wolfe conditions (Nocedal and Wright 2006, section 3.1)

// Applies a form of Armijo's test by slopes, for decreases that are lost in round-off: it does not subtract large
// numbers (Hager and Zhang 2005, "A new conjugate gradient method with guaranteed descent and an efficient line
// search", equation 4.1).
bool decreases_by_slope(const Change& change, double slope, double armijo, double noise) {
  return change.value <= noise && change.slope <= (2 * armijo - 1) * slope;
}

// Finds the contacts at the trial point, which was accepted with the planes of the search. They are kept unless they
// make the point worse than where the search began; the search could not know of them. Friction, whose normal forces
// are lagged, does not count here.
bool contacts_accept(const Model& model, const StepInputs& inputs, OpenWorkspace& w, double change, double noise) {
  if (!has_colliders(inputs)) return true;
  find_contacts_of(model, inputs, w, w.trial);
  const double jump = contact_energy(w.trial.contacts, w.trial.x) - contact_energy(w.current.contacts, w.trial.x);
  return jump <= 0 || change + jump <= noise;
}

// Tries alpha = 1, 1/2, ...
Search backtrack(const Model& model, const StepInputs& inputs, OpenWorkspace& w, double slope, bool may_learn,
                 Change& change, IterationRecord& record) {
  const SolverSettings& solver = inputs.solver;
  const double noise = noise_of(model, w.current.g, extent_of(model, w));
  double alpha = 1;
  int refused = 0;
  for (int halving = 0; halving <= most_halvings; ++halving, alpha /= 2) {
    set_trial(model, w, alpha);
    const bool by_slope = -alpha * slope < noise / solver.armijo;
    // The first trial nearly always succeeds, and its gradient becomes that of the next iterate. After a rejection only
    // the energy decides.
    const bool with_gradient = halving == 0 || by_slope;
    change = evaluate_trial(model, w, with_gradient ? Wanted::gradient : Wanted::value);
    ++w.report.line_search;
    record.alpha = alpha;
    const bool accepted = by_slope ? decreases_by_slope(change, slope, solver.armijo, noise)
                                   : change.value <= solver.armijo * alpha * slope;
    if (halving == 0) record.full = {accepted, change.slope / slope};
    if (!accepted || !std::isfinite(change.value)) {
      // Where slopes are lost in round-off too, shorter steps only repeat the noise. A thousandth of the noise stands
      // for a negligible distance, and a slope below the energy of the positions' last bits is noise itself.
      if (by_slope && -slope < 1e-3 * noise + noise_of(model, 0, extent_of(model, w))) return Search::exhausted;
      continue;
    }
    if (!with_gradient) change = evaluate_trial(model, w, Wanted::gradient);
    if (contacts_accept(model, inputs, w, change.value, noise)) return Search::found;
    if (refused == 0 && may_learn && learn_contacts(model, inputs, w)) return Search::unforeseen;
    // A shorter step helps against contacts of which the current iterate can't learn, but not where the energy itself
    // jumps (a vertex that passes an edge).
    if (++refused == most_refusals) return Search::worse;
  }
  return Search::failed;
}

// Holds a trial point of a search by slopes.
struct Trial {
  double alpha, value, slope;
};

// Satisfies the strong Wolfe conditions by bracketing and zooming (Nocedal and Wright 2006, algorithms 3.5 and 3.6,
// with the minimiser of the cubic through both ends, kept away from them). Every trial costs a gradient. A point whose
// contacts are refused, as in backtrack(), counts as too far away.
class WolfeSearch {
 public:
  WolfeSearch(const Model& model, const StepInputs& inputs, OpenWorkspace& w, double slope, Change& change,
              IterationRecord& record)
      : model_(model),
        inputs_(inputs),
        w_(w),
        slope_(slope),
        noise_(noise_of(model, w.current.g, extent_of(model, w))),
        change_(change),
        record_(record) {}

  Search run() {
    Trial before{0, 0, slope_};
    double alpha = 1;
    for (int i = 0; i < 12; ++i, alpha *= 2) {
      const Trial at = evaluate_at(alpha);
      if (i == 0) record_.full = {enough(at), at.slope / slope_};
      if (!enough(at) || (i > 0 && at.value >= before.value)) return zoom(before, at);
      if (!contacts_accept(at)) return zoom(before, at);
      if (flat(at)) return Search::found;
      if (at.slope >= 0) return zoom(at, before);
      before = at;
    }
    return Search::found;
  }

 private:
  Trial evaluate_at(double alpha) {
    set_trial(model_, w_, alpha);
    change_ = evaluate_trial(model_, w_, Wanted::gradient);
    ++w_.report.line_search;
    record_.alpha = alpha;
    if (!std::isfinite(change_.value)) return {alpha, std::numeric_limits<double>::infinity(), 0};
    return {alpha, change_.value, change_.slope};
  }
  bool enough(const Trial& t) const { return t.value <= inputs_.solver.armijo * t.alpha * slope_; }
  bool flat(const Trial& t) const { return std::abs(t.slope) <= -curvature_share * slope_; }
  bool contacts_accept(const Trial& at) {
    return supple::contacts_accept(model_, inputs_, w_, at.value, noise_) || ++refused_ >= most_refusals;
  }

  Search zoom(Trial low, Trial high) {
    for (int i = 0; i < most_halvings; ++i) {
      const Trial at = evaluate_at(between(low, high));
      if (!enough(at) || at.value >= low.value || !contacts_accept(at)) {
        high = at;
      } else {
        if (flat(at)) return Search::found;
        if (at.slope * (high.alpha - low.alpha) >= 0) high = low;
        low = at;
      }
      if (std::abs(high.alpha - low.alpha) < 1e-8) break;
    }
    if (low.alpha <= 0) return Search::failed;
    evaluate_at(low.alpha);
    find_contacts_of(model_, inputs_, w_, w_.trial);
    return Search::found;
  }

  static double between(const Trial& a, const Trial& b) {
    const double width = b.alpha - a.alpha;
    double at = 0.5;
    if (std::isfinite(b.value)) {
      const double d1 = a.slope + b.slope - 3 * (b.value - a.value) / width;
      const double under = d1 * d1 - a.slope * b.slope;
      if (under >= 0) {
        const double d2 = std::copysign(std::sqrt(under), width);
        at = 1 - (b.slope + d2 - d1) / (b.slope - a.slope + 2 * d2);
      }
    }
    if (!(at > 0.1)) at = 0.1;
    return a.alpha + std::min(at, 0.9) * width;
  }

  const Model& model_;
  const StepInputs& inputs_;
  OpenWorkspace& w_;
  double slope_;
  double noise_;
  int refused_ = 0;  // trial points refused for the contacts found there
  Change& change_;
  IterationRecord& record_;
};

}  // namespace

double extent_of(const Model& model, const OpenWorkspace& w) {
  return w.current.x.topRows(model.free).cwiseAbs().maxCoeff();
}

bool below_resolution(const Model& model, const OpenWorkspace& w) {
  const double extent = extent_of(model, w);
  return w.direction.cwiseAbs().maxCoeff() <= 4 * round_off * std::max(extent, model.size);
}

Search search_line(const Model& model, const StepInputs& inputs, OpenWorkspace& w, double slope, bool may_learn,
                   Change& change, IterationRecord& record) {
  const double noise = noise_of(model, w.current.g, extent_of(model, w));
  if (inputs.solver.line_search == LineSearch::wolfe && -slope > noise / inputs.solver.armijo)
    return WolfeSearch(model, inputs, w, slope, change, record).run();
  return backtrack(model, inputs, w, slope, may_learn, change, record);
}

}  // namespace supple
