// Signals that ask the program to end, kept away from code that must not meet them.
#pragma once

#include <csignal>

namespace supple {

// While one lives, this thread takes no SIGINT, SIGTERM and SIGHUP, and threads that it starts never do: another thread
// takes them, or they wait. What is done with SIGTERM and SIGABRT is put back at the end.
class SignalsWait {
 public:
  SignalsWait() {
    sigset_t ends;
    sigemptyset(&ends);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&ends, signal);
    pthread_sigmask(SIG_BLOCK, &ends, &before_);
    sigaction(SIGTERM, nullptr, &terminate_);
    sigaction(SIGABRT, nullptr, &abort_);
  }
  ~SignalsWait() {
    sigaction(SIGTERM, &terminate_, nullptr);
    sigaction(SIGABRT, &abort_, nullptr);
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  SignalsWait(const SignalsWait&) = delete;
  SignalsWait& operator=(const SignalsWait&) = delete;

 private:
  sigset_t before_;
  struct sigaction terminate_, abort_;
};

}  // namespace supple
