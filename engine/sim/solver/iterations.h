// Runs one search of a step: the iterations of algorithm 1 (Liu et al. 2017) from the current iterate, until they are
// spent, near enough, or come to nothing. Which searches a step makes, and in what order, is told in step.cpp.
#pragma once

#include "sim/model/state.h"
#include "sim/solver/search_rule.h"
#include "sim/solver/time_budget.h"

namespace supple {

// Tells what a step began with.
struct Origin {
  const State& state;
  double above_start;   // g(y) - g of its first iterate, where that is known [J]
  bool newton_follows;  // where the iterations come to nothing
};

// Tells where a search ends at the latest.
struct Limits {
  int iterations;
  int iterations_of_rounds;      // where the answer so far gains energy from nothing
  double enough = 0;             // a direction that promises less ends the search, -tr(grad^T d) [J]
  TimeBudget* budget = nullptr;  // null: time has no bound
  bool newton_follows = false;   // the search ends where it tries too many points: Newton's method does better there
  bool finishing = false;        // it makes one iteration at least, and ends where contacts make the next iterate worse
};

// Runs the iterations from the current iterate, which has been evaluated. origin: of the step that the search begins;
// null for other searches, which make no more rounds. Returns whether it gave up because of its trials.
bool run_iterations(const Model& model, const StepInputs& inputs, Workspace& workspace, SearchRule& rule,
                    const Limits& limits, const Origin* origin = nullptr);

// Minimises g from workspace.current.x; adds to the report's decrease, and sets its slope and stop reason. Also stops
// once a direction promises less than `enough` [J]. It serves references.
void minimize(const Model& model, const StepInputs& inputs, Workspace& workspace, double enough = 0);
void minimize(const Model& model, const StepInputs& inputs, Workspace& workspace, SearchRule& rule, double enough = 0);

// Makes the report that of a step which failed in the named phase, at this objective [J].
void fail(const Model& model, Workspace& workspace, const char* phase, double objective);

}  // namespace supple
