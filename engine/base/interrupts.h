// Counts requests from outside that the program should end: SIGINT, SIGTERM, and SIGHUP when the terminal is gone. Long
// work asks for them between two of its parts. Not here: keeping them away from code (signals.h).
#pragma once

namespace supple {

// Returns true once a request has come. SIGHUP does not count under nohup.
bool interrupted();

// From now on counts requests instead of ending at the first one. The third one ends the program at once.
void catch_interrupts();

}  // namespace supple
