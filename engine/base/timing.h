// Measures wall-clock durations in milliseconds. They are never a source of decisions: nothing that changes a result
// may depend on a clock, except for a budget of time that a scene asks for (sim/solver/step.cpp).
#pragma once

#include <chrono>

namespace supple {

class Stopwatch {
 public:
  double elapsed_ms() const { return std::chrono::duration<double, std::milli>(Clock::now() - start_).count(); }

  // Returns the milliseconds since the start or the last lap, and starts the next lap.
  double lap_ms() {
    const Clock::time_point now = Clock::now();
    const double ms = std::chrono::duration<double, std::milli>(now - start_).count();
    start_ = now;
    return ms;
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
};

}  // namespace supple
