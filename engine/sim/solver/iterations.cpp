#include "sim/solver/iterations.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim/solver/bow_search.h"
#include "sim/solver/element_precision.h"
#include "sim/solver/lbfgs.h"
#include "sim/solver/line_search.h"
#include "sim/solver/place_iterate.h"
#include "sim/solver/total_momentum.h"
#include "sim/solver/unforeseen_contacts.h"

namespace supple {
namespace {

int first_bad_vertex(const Model& model, const Positions& x) {
  int worst = 0;
  double furthest = -1;
  for (int v = 0; v < model.vertices; ++v) {
    if (!x.row(v).allFinite()) return model.input_of[v];
    const double away = (x.row(v) - model.rest.row(v)).norm();
    if (away > furthest) {
      furthest = away;
      worst = v;
    }
  }
  return model.input_of[worst];
}

// Tells whether an objective is that of a body that flies apart: many times the energy that moves all of the body by
// its own size in one step.
bool absurd(const Model& model, double objective, double start) {
  const double speed = model.size / model.time_step;
  return !std::isfinite(objective) || objective > 1e6 * (0.5 * model.total_mass * speed * speed + std::abs(start));
}

// Asks the rule for a direction that leads downhill. If it does not, asks again after the rule has forgotten what it
// learned.
FoundDirection next_direction(const Model& model, const StepInputs& inputs, OpenWorkspace& w, SearchRule& rule) {
  const TimedPhase timed(w.clock, Phase::other, "direction");
  for (;;) {
    w.report.slope = rule.direction(model, inputs, w);
    if (is_isolated(model, w, w.current.contacts)) w.report.slope += restore_common_translation(model, w);
    const double slope = w.report.slope;
    if (below_resolution(model, w)) return {true, slope};
    if (slope < 0) return {false, slope};
    if (!rule.forget()) return {true, slope};
  }
}

// Searches along the direction for the next iterate, and leaves it in the trial iterate. A search that meets contacts
// which it did not foresee is repeated, a few times, along a direction that knows them: adding constraints where an
// iterate violates them, and solving again, is the exchange method of semi-infinite programs (Hettich and Kortanek
// 1993). A search that fails is repeated once along the direction of a rule that has forgotten what it learned.
Search find_next(const Model& model, const StepInputs& inputs, OpenWorkspace& w, SearchRule& rule, double slope,
                 Change& change, IterationRecord& record) {
  const TimedPhase timed(w.clock, Phase::evaluate, "line search");
  if (inputs.solver.line_search == LineSearch::none) {
    set_trial(model, w, 1);
    change = evaluate_trial(model, w, rule.needs_gradient() ? Wanted::gradient : Wanted::value);
    ++w.report.line_search;
    find_contacts_of(model, inputs, w, w.trial);
    return Search::found;
  }
  int lessons = 0;
  for (;;) {
    bow_search(model, inputs, slope, w);
    const Search search = search_line(model, inputs, w, slope, lessons < most_lessons, change, record);
    if (search == Search::unforeseen) {
      ++lessons;
    } else if (search == Search::failed && rule.forget()) {
      lessons = most_lessons;
    } else {
      return search;
    }
    const FoundDirection again = next_direction(model, inputs, w, rule);
    if (again.done) return Search::exhausted;
    slope = again.slope;
  }
}

// Gives the trial iterate the contacts that the search used, renewed there. Corrects its gradient; returns the change
// of its objective, which is one of friction [J].
double keep_contacts(OpenWorkspace& w) {
  Iterate& to = w.trial;
  to.keeps_contacts = false;
  to.contacts.swap(w.current.contacts);
  double jump = 0;
  const bool rub = std::ranges::any_of(to.contacts, [](const Contact& contact) { return contact.coefficient > 0; });
  if (rub) jump -= add_contacts(to.contacts, to.x, nullptr, w.direction, &to.gradient, -1).value;
  const int changes = renew_contacts(to.x, to.contacts);
  if (rub) jump += add_contacts(to.contacts, to.x, nullptr, w.direction, &to.gradient).value;
  count_contacts(changes, to.contacts, w.contact);
  return jump;
}

// Replaces the contacts that the search used with those of the trial point. Corrects the trial's gradient; returns the
// change of its objective [J].
double take_contacts(OpenWorkspace& w) {
  Iterate& to = w.trial;
  if (to.keeps_contacts) return keep_contacts(w);
  double jump = 0;
  jump -= add_contacts(w.current.contacts, to.x, nullptr, w.direction, &to.gradient, -1).value;
  jump += add_contacts(to.contacts, to.x, nullptr, w.direction, &to.gradient).value;
  count_contacts(w.current.contacts, to.contacts, w.contact);
  return jump;
}

// Makes the trial iterate the current one. before: g where the iteration began, without contacts learned since [J].
void accept(const Model& model, const StepInputs& inputs, OpenWorkspace& w, SearchRule& rule, double before,
            Change change, IterationRecord& record) {
  const TimedPhase timed(w.clock, Phase::lbfgs, "accept");
  w.lengths.add(model, w.direction, record.alpha);
  rule.accepted(model, inputs, w);
  if (may_touch(inputs)) change.value += take_contacts(w);
  const double learned = w.current.g - before;
  w.trial.g = w.current.g + change.value - change.excess;
  std::swap(w.current, w.trial);
  ++w.report.iterations;
  w.report.objective.push_back(w.current.g);
  w.report.decrease -= change.value - change.excess;
  record.decrease = -change.value - learned;
  record.elapsed_ms = w.clock.elapsed_ms();
  w.report.records.push_back(record);
  if (w.watch) w.watch(w.current.x);
}

// Tells whether bodies that touch each other went so little of a direction's way that what the rule learned from
// earlier iterates is about other contacts. Eight creatures that settled in a bowl took 1.1 evaluations an iteration
// in place of 2.3.
bool was_cut_short(const Model& model, const IterationRecord& record) {
  constexpr double most = 0.3;
  return model.parts.size() > 1 && record.alpha < most;
}

}  // namespace

void fail(const Model& model, OpenWorkspace& w, const char* phase, double objective) {
  w.report.failed = true;
  w.report.failure.during = phase;
  w.report.failure.vertex = first_bad_vertex(model, w.current.x);
  w.report.failure.what =
      std::isfinite(objective) ? "the objective has grown beyond all bounds" : "a number is no longer finite";
}

Iterations::Iterations(const Model& model, const StepInputs& inputs, OpenWorkspace& w, SearchRule& rule,
                       const SearchOrigin& origin)
    : model_(model),
      inputs_(inputs),
      w_(w),
      rule_(rule),
      origin_(origin),
      first_(w.report.objective.size() - 1),
      start_(w.current.g),
      tried_(w.report.line_search) {
  w.report.remaining_estimate = 0;
  if (!std::isfinite(start_)) {
    fail(model, w, "evaluate", start_);
    return;
  }
  w.second_level_serves = w.is_bowed = false;
  w.correction.second = nullptr;
  rule.begin(model, inputs, w);
  w.report.stop_reason = StopReason::iterations;
  w.report.decrement = 0;
  w.report.iterations = 0;
}

void Iterations::run(const SearchLimits& limits) {
  if (w_.report.failed) return;
  while (!reaches(limits)) {
    if (advance(limits)) continue;
    end_ = SearchEnd::settled;
    break;
  }
  go_over_to_double(model_, w_);
}

void Iterations::look_further(const SearchLimits& limits) {
  if (end_ == SearchEnd::settled || !rule_.measures_last_iterate()) return;
  has_begun_ = true;
  if (!has_direction(limits)) end_ = SearchEnd::settled;
}

// Tells whether the search has come to one of its limits, and notes which one.
bool Iterations::reaches(const SearchLimits& limits) {
  StepReport& report = w_.report;
  if (limits.budget != nullptr && limits.budget->is_spent(report.iterations)) {
    report.stop_reason = StopReason::budget;
    end_ = SearchEnd::time;
  } else if (report.line_search - tried_ > limits.trials) {
    end_ = SearchEnd::trials;
  } else if (report.iterations >= limits.iterations) {
    end_ = SearchEnd::iterations;
  } else {
    return false;
  }
  return true;
}

// Sets the direction at the current iterate, and the precision that it is worth.
FoundDirection Iterations::find_direction(const SearchLimits& limits) {
  const FoundDirection descent = next_direction(model_, inputs_, w_, rule_);
  if (limits.begins_in_single && !std::exchange(has_begun_, true) && !descent.done)
    begin_in_single(model_, descent.slope, w_);
  const bool is_enough = !descent.done && is_single_enough(model_, descent.slope);
  return is_enough || !go_over_to_double(model_, w_) ? descent : next_direction(model_, inputs_, w_, rule_);
}

// Sets the direction at the current iterate, and estimates what is left there. Returns false where the search ends
// because the direction promises too little, or because the step has failed.
bool Iterations::has_direction(const SearchLimits& limits) {
  StepReport& report = w_.report;
  const FoundDirection descent = find_direction(limits);
  if (!std::isfinite(descent.slope)) {
    fail(model_, w_, "solve", descent.slope);
    return false;
  }
  report.decrement = descent.done ? 0 : -0.5 * descent.slope;
  if (rule_.measures_last_iterate()) report.remaining_estimate = decrements_.left(2 * report.decrement);
  const bool has_enough = -descent.slope <= limits.enough && report.iterations >= limits.least_iterations;
  if (!descent.done && !has_enough) return true;
  report.stop_reason = StopReason::round_off;
  return false;
}

// Makes one iteration. Returns false where the search ends.
bool Iterations::advance(const SearchLimits& limits) {
  StepReport& report = w_.report;
  if (!has_direction(limits)) return false;
  if (rule_.measures_last_iterate() && is_near_enough(model_, inputs_, origin_.q, origin_.above_start, w_)) {
    report.stop_reason = StopReason::target_error;
    return false;
  }
  if (rule_.measures_last_iterate() && origin_.q != nullptr &&
      is_still(model_, inputs_, *origin_.q, report.decrease + origin_.above_start, w_)) {
    report.stop_reason = StopReason::still;
    return false;
  }
  Change change{};
  IterationRecord record;
  const double before = w_.current.g, slope = report.slope;
  w_.is_last_iteration = report.iterations + 1 >= limits.iterations;
  const Search found = find_next(model_, inputs_, w_, rule_, slope, change, record);
  if (found != Search::found && go_over_to_double(model_, w_)) return true;
  const bool is_taken = found == Search::worse && limits.worse_iterate == WorseIterate::taken;
  if (found != Search::found && !is_taken) {
    // A first search that finds nothing above round-off leaves nothing to gain, and nothing to compare it with.
    if (found == Search::exhausted && report.iterations == 0) report.remaining_estimate = 0;
    report.stop_reason = found == Search::exhausted ? StopReason::round_off : StopReason::line_search_failed;
    return false;
  }
  accept(model_, inputs_, w_, rule_, before, change, record);
  if (was_cut_short(model_, record)) rule_.forget();
  decrements_.add(-slope, record.decrease);
  if (absurd(model_, w_.current.g, start_)) {
    fail(model_, w_, "line search", w_.current.g);
    return false;
  }
  if (rule_.measures_last_iterate()) return true;
  report.remaining_estimate = left_by_decreases(report.objective, first_);
  if (!is_near_enough(model_, inputs_, nullptr, origin_.above_start, w_)) return true;
  report.stop_reason = StopReason::target_error;
  return false;
}

SearchEnd run_search(const Model& model, const StepInputs& inputs, OpenWorkspace& w, SearchRule& rule,
                     const SearchLimits& limits, const SearchOrigin& origin) {
  Iterations iterations(model, inputs, w, rule, origin);
  iterations.run(limits);
  iterations.look_further(limits);
  return iterations.end();
}

void minimize(const Model& model, const StepInputs& inputs, OpenWorkspace& w, double enough) {
  SystemInverse system;
  LbfgsRule rule(system);
  minimize(model, inputs, w, rule, enough);
}

void minimize(const Model& model, const StepInputs& inputs, OpenWorkspace& w, SearchRule& rule, double enough) {
  evaluate_start(model, inputs, w);
  run_search(model, inputs, w, rule, {.iterations = inputs.solver.iterations, .enough = enough});
}

}  // namespace supple
