// Runs one search of a step: the iterations of algorithm 1 (Liu et al. 2017) from the current iterate, until they are
// spent, near enough, or come to nothing. Which searches a step makes, and in what order, is told in step.cpp.
#pragma once

#include <limits>

#include "sim/solver/error_estimate.h"
#include "sim/solver/search_rule.h"
#include "sim/solver/step_context.h"
#include "sim/solver/time_budget.h"

namespace supple {

// Tells what a search does with an iterate that is worse because of contacts that were found only there, and that the
// iterate before could not learn.
enum class WorseIterate {
  taken,    // the iterations after it know the contacts
  refused,  // it ends the search: g never rises
};

// Tells where a search ends at the latest.
struct SearchLimits {
  int iterations = 0;                            // iterations at most, counted from where the search began
  int trials = std::numeric_limits<int>::max();  // points that its line searches may try before it gives up
  double enough = 0;                             // the search ends at a direction that promises less, -tr(grad^T d) [J]
  int least_iterations = 0;                      // iterations that the search makes whatever they promise
  WorseIterate worse_iterate = WorseIterate::taken;
  TimeBudget* budget = nullptr;   // null: time has no bound
  bool begins_in_single = false;  // elements may be evaluated in single precision first (element_precision.h)
};

// Tells why a search ended.
enum class SearchEnd {
  iterations,  // it has made all that it may
  time,        // no further one fits into the budget of time
  trials,      // it gave up: its line searches have tried more points than they may
  settled,     // there is nothing more to gain here: see StepReport::stop_reason; or the step has failed
};

// Tells what a step has done before a search, for estimates of its errors.
struct SearchOrigin {
  const Positions* q = nullptr;  // start of the step, n x 3 [m]; null: the error of motion is of no interest
  double above_start = 0;        // g(y) - g of the first iterate, where that is known [J]
};

inline SearchOrigin origin_of(const StepContext& c) { return {&c.state.x, c.above_start}; }

// Tells what a direction promises.
struct FoundDirection {
  bool done = false;  // nothing is left that is worth a search
  double slope = 0;   // tr(grad^T d) [J]
};

// Goes from iterate to iterate. The report's iterations are this search's; its decrease is the sum over all searches.
class Iterations {
 public:
  // Begins a search at workspace.current, which has been evaluated.
  Iterations(const Model& model, const StepInputs& inputs, OpenWorkspace& workspace, SearchRule& rule,
             const SearchOrigin& origin = {});

  // Iterates until the search ends. A search that ended by its limits goes on when run() is called again with wider
  // limits.
  void run(const SearchLimits& limits);

  // Computes the direction at the last iterate, in double precision, where the rule asks for that. The direction tells
  // what is left to gain, which may be nothing. To be called after the last run(); does nothing to a search that has
  // settled.
  void look_further(const SearchLimits& limits);

  SearchEnd end() const { return end_; }

 private:
  bool reaches(const SearchLimits& limits);
  bool has_direction(const SearchLimits& limits);
  FoundDirection find_direction(const SearchLimits& limits);
  bool advance(const SearchLimits& limits);

  const Model& model_;
  const StepInputs& inputs_;
  OpenWorkspace& w_;
  SearchRule& rule_;
  SearchOrigin origin_;
  SearchEnd end_ = SearchEnd::settled;
  std::size_t first_;       // place of the search's first iterate in the report's objectives
  double start_;            // g at the first iterate [J]
  int tried_;               // points that earlier searches tried
  bool has_begun_ = false;  // it is too late to begin in single precision
  Decrements decrements_;
};

// Runs a search to its end, and looks further. Returns why it ended.
SearchEnd run_search(const Model& model, const StepInputs& inputs, OpenWorkspace& workspace, SearchRule& rule,
                     const SearchLimits& limits, const SearchOrigin& origin = {});

// Minimises g from workspace.current.x; adds to the report's decrease, and sets its slope and stop reason. Also stops
// once a direction promises less than `enough` [J]. These functions serve references and first_forces.h.
void minimize(const Model& model, const StepInputs& inputs, OpenWorkspace& workspace, double enough = 0);
void minimize(const Model& model, const StepInputs& inputs, OpenWorkspace& workspace, SearchRule& rule,
              double enough = 0);

// Makes the report that of a step which failed in the named phase, at this objective [J].
void fail(const Model& model, OpenWorkspace& workspace, const char* phase, double objective);

}  // namespace supple
