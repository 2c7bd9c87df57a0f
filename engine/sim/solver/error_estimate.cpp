#include "sim/solver/error_estimate.h"

#include <algorithm>
#include <cmath>

#include "sim/coarse/rest_moduli.h"
#include "sim/contact/contact.h"
#include "sim/model/motion_error.h"
#include "sim/solver/line_search.h"
#include "sim/solver/place_iterate.h"

namespace supple {

void Decrements::add(double decrement, double gained) {
  for (int i = most - 1; i > 0; --i) before_[i] = before_[i - 1];
  before_[0] = {decrement, std::max(gained, 0.0)};
  count_ = std::min(count_ + 1, most);
}

// No direction's matrix is the Hessian, so what is left is an unknown number of decrements. If that number is the same
// at both ends of some iterations, it cancels: the gain that is left is to the gain of these iterations as the last
// decrement is to the difference of the first and the last. A ratio above `slowest` tells that decrements do not
// shrink, not what is left.
double Decrements::left(double decrement) const {
  constexpr double slowest = 0.85;
  double gained = 0, logarithms = 0;
  for (int i = 0; i < count_; ++i) {
    gained += before_[i].gained;
    const double ratio = std::min(slowest, decrement / before_[i].decrement);
    logarithms += std::log(gained * ratio / (1 - ratio));
  }
  return count_ == 0 ? decrement : std::max(decrement, std::exp(logarithms / count_));
}

// Decreases of quasi-Newton iterations shrink unevenly, so the ratio is averaged over the last three. With fewer than
// two decreases, the estimate of what is left is the gain so far.
double left_by_decreases(const std::vector<double>& g, std::size_t first) {
  const std::size_t steps = g.size() - 1 - first;
  if (steps < 2) return steps == 0 ? 0 : std::max(0.0, g[first] - g[first + 1]);
  const double last = g[g.size() - 2] - g.back();
  const std::size_t back = std::min<std::size_t>(3, steps - 1);
  const double earlier = g[g.size() - 2 - back] - g[g.size() - 1 - back];
  if (last <= 0 || earlier <= 0) return 0;
  const double ratio = std::min(0.95, std::pow(last / earlier, 1.0 / static_cast<double>(back)));
  return last * ratio / (1 - ratio);
}

double error_of(double left, double gained) { return left > 0 ? left / (std::max(gained, 0.0) + left) : 0; }

namespace {

// Returns how far the energy of the contacts alone would be above g of the last iterate, if the body had gone to y [J];
// 0 where nothing may touch. An impact ends the first iterate before y, where g is not evaluated; but y lies deep in
// what is hit, and equation 12 counts from y. The energy of the elements at y is left out.
double below_prediction(const Model& model, const StepInputs& inputs, OpenWorkspace& w) {
  if (!may_touch(inputs) || w.report.failed) return 0;
  if (!w.contact_energy_at_y) {
    w.trial.x.topRows(model.free) = w.y.topRows(model.free);
    find_contacts_of(model, inputs, w, w.trial);
    w.contact_energy_at_y = contact_energy(w.trial.contacts, w.trial.x);
  }
  return *w.contact_energy_at_y - w.current.g;
}

}  // namespace

// Contacts that are found on the way may raise g in an iteration; this takes nothing from what other iterations gained.
double gained_in_all(const Model& model, const StepInputs& inputs, OpenWorkspace& w, double gained) {
  double searched = 0;
  for (const IterationRecord& iteration : w.report.records) searched += std::max(0.0, iteration.decrease);
  return std::max({gained, searched, below_prediction(model, inputs, w)});
}

double error_at_end(const Model& model, const StepInputs& inputs, OpenWorkspace& w, double gained) {
  const double left = w.report.remaining_estimate;
  if (left <= noise_of(model, w.current.g, extent_of(model, w))) return 0;
  return error_of(left, gained_in_all(model, inputs, w, gained));
}

namespace {

// Returns the last direction with what the second level adds to it (n_free x 3) [m].
const Positions& way_ahead(const Model& model, const StepInputs& inputs, OpenWorkspace& w) {
  Positions& d = w.trial.gradient;
  d = w.direction;
  if (inputs.solver.levels < 2 && !w.second_level_serves && w.second_level.begin(model, w.current.x)) {
    w.scratch = -w.current.gradient;
    w.second_level.add_to(model, w.scratch, w.threads, d);
  }
  return d;
}

// Returns how many times the length of the last direction is left to go. The direction's quadratic model foretells a
// gain of half the decrement. If the gain that is left is N times the foretold one, the way that is left is sqrt(N)
// times the direction.
double times_ahead(const StepReport& report) {
  return std::sqrt(std::max(1.0, report.remaining_estimate / report.decrement));
}

// Returns what the last direction promises to gain over the geometric mean of what the last five iterations gained, or
// 0 where none of them gained anything.
double promise_over_gains(const StepReport& report) {
  constexpr int most = 5;
  double logarithms = 0;
  int count = 0;
  for (auto it = report.records.rbegin(); it != report.records.rend() && count < most; ++it) {
    if (it->decrease <= 0) continue;
    logarithms += std::log(it->decrease);
    ++count;
  }
  return count == 0 ? 0 : report.decrement / std::exp(logarithms / count);
}

// Returns the weight that the logarithm of the most that can be left has beside that of the way ahead. A search that
// converges promises about a tenth of what its last iterations gained, and its way ahead is a good forecast. One that
// goes on gaining as much as before has motions left which A takes for far stiffer than they are, and directions hardly
// show those of a material that is loose at rest. The numbers were fitted, without the second forecast, to 5,600 steps
// of stiff bodies (docs/lab/2026-11-28-estimates-that-go-on.md).
double weight_of_most(const Model& model, const StepReport& report) {
  constexpr double converging = 0.3, going_on = 0.6, most_weight = 0.4;
  if (report.newton_iterations > 0) return 0;  // Newton's matrix knows what is soft
  const double promise = promise_over_gains(report);
  if (promise <= converging || !has_loose_material(model)) return 0;
  return most_weight * std::min(1.0, (promise - converging) / (going_on - converging));
}

// Returns a way that is no shorter than what is left, where the energy is convex: then the Hessian of g resists no
// motion less than inertia does, and the distance from the minimum is at most h^2/w |grad g| in the norm of the inverse
// mass (Nesterov 2004, "Introductory lectures on convex optimization", theorem 2.1.9; n_free x 3) [m].
const Positions& longest_way(const Model& model, OpenWorkspace& w) {
  const double mobility = model.time_step * model.time_step / model.scheme.inertia;
  for (int v = 0; v < model.free; ++v) w.scratch.row(v) = -mobility / model.mass[v] * w.current.gradient.row(v);
  return w.scratch;
}

// Joins two forecasts of how far a part still has to go, of which the second may be missing (0). Each is off by a
// factor of its own, so that their geometric mean is nearer than either. Directions that resist turning show nothing of
// a turn, and their lengths foretell none; so the way ahead, to which the second level adds the turn, counts by a
// quarter at least. Cloth bends so easily that each forecast sees motions that the other does not, and they add up
// (docs/lab/2026-11-29-estimates-for-cloth.md).
double joined_forecasts(const Part& part, double ahead, double foretold) {
  constexpr double least_share = 0.25;
  if (foretold <= 0) return ahead;
  if (!part.solid) return ahead + foretold;
  const double mean = std::sqrt(ahead * foretold), least = least_share * ahead;
  return mean < least ? least : mean;  // a mean that is not a number stays
}

// Estimates the error of motion of each part of a model.
class MotionEstimates {
 public:
  // Overwrites the trial iterate and the workspace's scratch.
  MotionEstimates(const Model& model, const StepInputs& inputs, const Positions& q, OpenWorkspace& w, double longer)
      : model_(model),
        q_(q),
        w_(w),
        way_(way_ahead(model, inputs, w)),
        times_(longer * times_ahead(w.report)),
        weight_(weight_of_most(model, w.report)),
        longest_(weight_ > 0 ? &longest_way(model, w) : nullptr) {}

  struct OfPart {
    double estimate;
    double ahead;  // by the way ahead alone
  };

  OfPart of(const Part& part) const {
    const double motion = own_motion(model_, part, q_, w_.y, w_.current.x);
    double ahead = times_ * mass_length(model_, part, way_);
    if (longest_ != nullptr) {
      const double most = mass_length(model_, part, *longest_);
      if (ahead > 0 && most > ahead) ahead *= std::pow(most / ahead, weight_);
    }
    const double foretold = w_.lengths.left(&part - model_.parts.data());
    return {joined_forecasts(part, ahead, foretold) / motion, ahead / motion};
  }

 private:
  const Model& model_;
  const Positions& q_;
  const OpenWorkspace& w_;
  const Positions& way_;
  double times_, weight_;
  const Positions* longest_;
};

bool has_way_ahead(const StepReport& report) { return !report.failed && report.decrement > 0; }

}  // namespace

double motion_ahead(const Model& model, const StepInputs& inputs, const Positions& q, OpenWorkspace& w) {
  if (!has_way_ahead(w.report)) return 0;
  const Positions& way = way_ahead(model, inputs, w);
  return times_ahead(w.report) * largest_of_parts(model, [&](const Part& part) {
           return mass_length(model, part, way) / own_motion(model, part, q, w.y, w.current.x);
         });
}

double motion_estimate(const Model& model, const StepInputs& inputs, const Positions& q, OpenWorkspace& w,
                       double longer) {
  if (!has_way_ahead(w.report)) return 0;
  const MotionEstimates estimates(model, inputs, q, w, longer);
  return largest_of_parts(model, [&](const Part& part) { return estimates.of(part).estimate; });
}

void report_motion_estimates(const Model& model, const StepInputs& inputs, const Positions& q, OpenWorkspace& w) {
  StepReport& report = w.report;
  report.motion_estimate = report.motion_ahead = 0;
  report.motion_estimates.clear();
  if (!has_way_ahead(report)) return;
  const MotionEstimates estimates(model, inputs, q, w, 1);
  const bool has_parts = model.parts.size() > 1;
  report.motion_estimate = largest_of_parts(model, [&](const Part& part) {
    const MotionEstimates::OfPart of_part = estimates.of(part);
    if (has_parts) report.motion_estimates.push_back(of_part.estimate);
    report.motion_ahead = std::max(report.motion_ahead, of_part.ahead);
    return of_part.estimate;
  });
}

bool is_near_enough(const Model& model, const StepInputs& inputs, const Positions* q, double above_start,
                    OpenWorkspace& w) {
  const double target = inputs.solver.target_error;
  if (target <= 0 || error_of(w.report.remaining_estimate, w.report.decrease + above_start) >= target) return false;
  return q == nullptr || motion_estimate(model, inputs, *q, w) < target;
}

namespace {

constexpr double small_error = 0.03;  // a film says that a step is unsolved from 0.1 on

}  // namespace

bool is_still(const Model& model, const StepInputs& inputs, const Positions& q, double gained, OpenWorkspace& w) {
  const SolverSettings& solver = inputs.solver;
  StepReport& report = w.report;
  if (solver.still <= 0 || solver.levels < 2) return false;
  const auto is_short = [&] { return way_in_sizes(model, w.direction) * times_ahead(report) < solver.still; };
  const auto leaves_little = [&] {
    report_motion_estimates(model, inputs, q, w);
    return report.motion_ahead < small_error && error_at_end(model, inputs, w, gained) < small_error;
  };
  if (!is_short() || !leaves_little()) return false;
  if (!w.correction.stuck.serves()) return true;
  Positions way;
  if (!solve_with_all_contacts(model, w.correction, w.current.gradient, way)) return false;
  const double decrement = report.decrement, left = report.remaining_estimate;
  report.decrement = 0.5 * (w.current.gradient.array() * way.array()).sum();
  report.remaining_estimate = left * (report.decrement / decrement);
  way = -way;
  w.direction.swap(way);
  if (is_short() && leaves_little()) return true;
  w.direction.swap(way);
  report.decrement = decrement;
  report.remaining_estimate = left;
  return false;
}

bool is_far(const Model& model, const StepInputs& inputs, const Positions& q, bool has_gone_on, OpenWorkspace& w) {
  constexpr double seen = 1e-4;           // body sizes
  constexpr double smaller_error = 0.01;  // for one that has gone on, however short its way: most of it may be missing
  if (!has_way_ahead(w.report)) return false;
  if (!has_gone_on && way_in_sizes(model, w.direction) * times_ahead(w.report) < seen) return false;
  return motion_estimate(model, inputs, q, w) > (has_gone_on ? smaller_error : small_error);
}

}  // namespace supple
