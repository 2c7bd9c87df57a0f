// Requests from outside that the program should end: SIGINT, SIGTERM, and SIGHUP when the terminal is gone. They are
// counted here; long work asks for them between two of its parts. Not here: keeping them away from code (signals.h).
#pragma once

namespace supple {

// True once a request came. SIGHUP does not count under nohup.
bool interrupted();

// Counts requests from now on instead of ending at the first one. The third one ends the program at once.
void catch_interrupts();

}  // namespace supple
