// Shows what is being made before a film starts.
#pragma once

#include <fmt/core.h>
#include <unistd.h>

#include "base/console.h"
#include "base/slow_work.h"
#include "base/timing.h"

namespace supple {

// Shows what is being made: a line that is renewed on a terminal and wiped out at the end;
// elsewhere a plain line for what takes long.
class SlowWorkLine {
 public:
  explicit SlowWorkLine(bool quiet) : quiet_(quiet), terminal_(isatty(STDERR_FILENO) == 1) {}
  ~SlowWorkLine() { end(); }
  SlowWorkLine(const SlowWorkLine&) = delete;
  SlowWorkLine& operator=(const SlowWorkLine&) = delete;

  void show(const std::string& text) {
    const double elapsed = watch_.elapsed_ms() / 1000;
    if (quiet_ || elapsed - last_ < (terminal_ ? 0.1 : 5)) return;
    last_ = elapsed;
    shown_ = true;
    say(stderr, terminal_ ? fmt::format("\r\033[K{}", text) : text + "\n");
  }
  void end() {
    if (shown_ && terminal_) say(stderr, "\r\033[K");
    shown_ = false;
  }

 private:
  bool quiet_, terminal_, shown_ = false;
  double last_ = 0;
  Stopwatch watch_;
};

// line: must outlive the result.
inline SlowWork slow_work_with(bool cache, SlowWorkLine& line) {
  return {cache ? UserCache::of_user() : UserCache(), [&line](const std::string& text) { line.show(text); }};
}

}  // namespace supple
