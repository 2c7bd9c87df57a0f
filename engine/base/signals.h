// Keeps signals that ask the program to end away from code that must not receive them.
#pragma once

#include <csignal>

namespace supple {

// While one of these objects lives, SIGINT, SIGTERM and SIGHUP are blocked in the thread that made it. Threads that are
// started from there meanwhile have them blocked for their whole lives. Another thread receives the signals, or they
// stay pending. The destructor restores the handlers of SIGTERM and SIGABRT, which code in between may have replaced.
class BlockedSignals {
 public:
  BlockedSignals() {
    sigset_t ends;
    sigemptyset(&ends);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&ends, signal);
    pthread_sigmask(SIG_BLOCK, &ends, &before_);
    sigaction(SIGTERM, nullptr, &terminate_);
    sigaction(SIGABRT, nullptr, &abort_);
  }
  ~BlockedSignals() {
    sigaction(SIGTERM, &terminate_, nullptr);
    sigaction(SIGABRT, &abort_, nullptr);
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  BlockedSignals(const BlockedSignals&) = delete;
  BlockedSignals& operator=(const BlockedSignals&) = delete;

 private:
  sigset_t before_;
  struct sigaction terminate_, abort_;
};

}  // namespace supple
