// Counts requests from outside that the program should end: SIGINT, SIGTERM, and SIGHUP when the terminal is gone. Long
// work asks for them between two of its parts. Not here: how signals are kept away from code that must not receive them
// (signals.h).
#pragma once

namespace supple {

// Returns true once a request has come. SIGHUP does not count under nohup.
bool interrupted();

// Counts requests from now on, so that the first one does not end the program. The third one ends it at once.
void catch_interrupts();

}  // namespace supple
