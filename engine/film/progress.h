// Shows how far a film has come.
#pragma once

#include <fmt/core.h>
#include <unistd.h>

#include "base/console.h"
#include "base/text.h"
#include "base/timing.h"

namespace supple {

// Shows a line of progress on a terminal, and prints a plain line from time to time elsewhere.
class Progress {
 public:
  // start: number of frames that exist already.
  Progress(int frames, int start, bool quiet)
      : frames_(frames), start_(start), quiet_(quiet), terminal_(isatty(STDERR_FILENO) == 1) {}

  void show(int done) {
    const double elapsed = watch_.elapsed_ms() / 1000;
    const bool due = terminal_ ? elapsed - last_ > 0.1 : elapsed - last_ > 10;
    if (quiet_ || (!due && done != frames_)) return;
    last_ = elapsed;
    const std::string left = duration_text(elapsed / (done - start_) * (frames_ - done));
    say(stderr, fmt::format("{}frame {} of {}, {:.1f} a second, {} left{}", terminal_ ? "\r\033[K" : "", done, frames_,
                            (done - start_) / elapsed, left, terminal_ ? "" : "\n"));
    shown_ = true;
  }
  void end() {
    if (!quiet_ && terminal_ && shown_) say(stderr, fmt::format("\n"));
  }

 private:
  int frames_, start_;
  bool quiet_, terminal_, shown_ = false;
  double last_ = 0;
  Stopwatch watch_;
};

}  // namespace supple
