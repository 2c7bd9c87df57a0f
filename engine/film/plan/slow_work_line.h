// Shows what is being made before a film starts: on a terminal in a line that is renewed and wiped out at the end,
// elsewhere in a plain line now and then, for what takes long.
#pragma once

#include <fmt/core.h>
#include <unistd.h>

#include "base/console.h"
#include "base/slow_work.h"
#include "base/timing.h"

namespace supple {

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

// Returns slow work that is shown in a line, which must outlive the result. cache: whether it may use the user's cache.
inline SlowWork slow_work_with(bool cache, SlowWorkLine& line) {
  return {cache ? UserCache::of_user() : UserCache(), [&line](const std::string& text) { line.show(text); }};
}

}  // namespace supple
