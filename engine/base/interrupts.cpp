#include "base/interrupts.h"

#include <unistd.h>

#include <csignal>

namespace supple {
namespace {

volatile std::sig_atomic_t interrupt_count = 0;

extern "C" void on_interrupt(int signal) {
  // Both the system and the shell may tell that the terminal is gone: that is one request.
  if (signal == SIGHUP && interrupt_count > 0) return;
  interrupt_count = interrupt_count + 1;
  if (interrupt_count >= 3) _exit(130);  // the user does not want to wait for the frame in progress
}

}  // namespace

bool interrupted() { return interrupt_count > 0; }

void catch_interrupts() {
  struct sigaction action {};
  action.sa_handler = on_interrupt;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  struct sigaction before {};
  sigaction(SIGHUP, nullptr, &before);
  if (before.sa_handler != SIG_IGN) sigaction(SIGHUP, &action, nullptr);  // under nohup, SIGHUP stays ignored
}

}  // namespace supple
