// Tells by a step's own figures whether it came near its minimum.
#pragma once

namespace supple {

// The number of points that a search may try an iteration before its step counts as hard.
inline constexpr int most_trials_an_iteration = 4;

// Tells whether the minimum is far: an estimate of the error above 0.1, or iterations that tried more points than
// most_trials_an_iteration allows.
inline bool is_unsolved(double error_estimate, int iterations, int trials) {
  constexpr double worst_estimate = 0.1;
  return error_estimate > worst_estimate || (iterations > 0 && trials > most_trials_an_iteration * iterations);
}

}  // namespace supple
