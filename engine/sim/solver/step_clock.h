// Measures where the time of a step goes. One mechanism fills both the report's phases and the trace's zones: each
// moment of a step belongs to exactly one phase, so the phases add up to the step without anything being subtracted.
#pragma once

#include <array>
#include <chrono>

#include "base/trace.h"

namespace supple {

enum class Phase { other, evaluate, solve, lbfgs, collide, matrix };

class StepClock {
 public:
  // Begins a step, in the phase `other`.
  void start() {
    spent_ = {};
    phase_ = Phase::other;
    begin_ = since_ = Clock::now();
  }

  // Returns the milliseconds since the start.
  double elapsed_ms() const { return milliseconds(Clock::now() - begin_); }

  // Returns the milliseconds of a phase so far, without those since the last change of phase.
  double spent_ms(Phase phase) const { return milliseconds(spent_[static_cast<std::size_t>(phase)]); }

  // Counts the following time for `phase`. Returns the phase before.
  Phase change(Phase phase) {
    const Clock::time_point now = Clock::now();
    spent_[static_cast<std::size_t>(phase_)] += now - since_;
    since_ = now;
    return std::exchange(phase_, phase);
  }

 private:
  using Clock = std::chrono::steady_clock;
  static double milliseconds(Clock::duration duration) {
    return std::chrono::duration<double, std::milli>(duration).count();
  }

  Clock::time_point begin_, since_;
  Phase phase_ = Phase::other;
  std::array<Clock::duration, 6> spent_{};
};

// Counts the time of a scope for a phase, except for that of such scopes inside it, and makes the scope a zone of the
// trace. When the scope ends, the phase around it continues.
class TimedPhase {
 public:
  TimedPhase(StepClock& clock, Phase phase, const char* zone)
      : clock_(clock), outer_(clock.change(phase)), zone_(zone) {}
  ~TimedPhase() { clock_.change(outer_); }
  TimedPhase(const TimedPhase&) = delete;
  TimedPhase& operator=(const TimedPhase&) = delete;

  // Ends this phase and begins another one in its place.
  void next(Phase phase, const char* zone) {
    clock_.change(phase);
    zone_.next(zone);
  }

 private:
  StepClock& clock_;
  Phase outer_;
  Zone zone_;
};

}  // namespace supple
