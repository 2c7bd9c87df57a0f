// Ends the iterations of a step's search where a budget of time asks for it.
#pragma once

#include <algorithm>
#include <optional>
#include <utility>

#include "sim/model/inputs.h"
#include "sim/solver/open_workspace.h"

namespace supple {

// Tells when a search has to end, and notes in the report how many iterations it has made until then, so that a later
// run can end the search there without a clock.
class TimeBudget {
 public:
  enum Which { from_first_iterate, from_staying };
  TimeBudget(const StepInputs& inputs, OpenWorkspace& w, Which search)
      : limit_ms_(inputs.solver.budget_ms), w_(w), cut_(w.report.cuts.after[search]) {
    if (inputs.repeated_cuts) repeated_ = inputs.repeated_cuts->after[search];
    if (limit_ms_ > 0) last_ms_ = w.clock.elapsed_ms();
  }

  // Tells whether no further iteration fits after so many iterations. The next one is expected to take as long as the
  // longest so far; the first one is always made.
  bool is_spent(int iterations) {
    const bool spent = repeated_ ? iterations == *repeated_ : limit_ms_ > 0 && iterations > 0 && would_end_late();
    if (spent) cut_ = iterations;
    return spent;
  }

 private:
  bool would_end_late() {
    const double now = w_.clock.elapsed_ms();
    longest_ms_ = std::max(longest_ms_, now - std::exchange(last_ms_, now));
    // A search in single precision ends with an evaluation in double, which takes no longer than an iteration.
    const int iterations = w_.elements == Precision::single_precision ? 2 : 1;
    return now + iterations * longest_ms_ > limit_ms_;
  }

  double limit_ms_, last_ms_ = 0, longest_ms_ = 0;
  const OpenWorkspace& w_;
  int& cut_;
  // The number of iterations after which the earlier run's search was ended; -1: its budget did not end it.
  std::optional<int> repeated_;
};

}  // namespace supple
