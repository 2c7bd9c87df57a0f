// Holds what the parts of one step share: the problem, the memory they work in, and what the step has found out about
// itself so far. step() makes one for each step; first iterates (first_iterate.h) and searches
// (further_iterations.h, from_staying.h, newton_finish.h) read and write it.
#pragma once

#include <optional>

#include "sim/model/inputs.h"
#include "sim/model/state.h"
#include "sim/solver/open_workspace.h"

namespace supple {

class SearchRule;

struct StepContext {
  const Model& model;
  const StepInputs& inputs;
  const State& state;  // the state where the step begins
  OpenWorkspace& w;
  SearchRule& rule;  // the rule of the searches before Newton's method

  // What is known of the first iterate.
  std::optional<double> at_prediction = {};  // g(y) with handles at their targets, where the step left y by choice [J]
  bool spreads_handles = false;              // the first iterate has the handles' departure from y in it
  bool stopped = false;                      // an impact stopped the first iterate
  double above_start = 0;  // g(y) - g of the first iterate, where that is known: equation 12 counts from y [J]

  // What is known of the searches.
  bool gave_up = false;  // a search gave up, because its line searches tried too many points
};

// Tells whether the part of g that is not inertia may be below zero: by a material, or by gas that has spread.
inline bool energy_may_be_negative(const StepContext& c) {
  return c.model.energy_may_be_negative || c.w.air.have_gas();
}

}  // namespace supple
