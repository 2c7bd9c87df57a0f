// Tells by a step's own figures whether it came near its minimum.
#pragma once

namespace supple {

// Tells whether the minimum is far: an estimate of the error above 0.1, or iterations that tried more than four points
// each.
inline bool is_unsolved(double error_estimate, int iterations, int trials) {
  constexpr double worst_estimate = 0.1;
  constexpr int most_trials = 4;
  return error_estimate > worst_estimate || (iterations > 0 && trials > most_trials * iterations);
}

}  // namespace supple
