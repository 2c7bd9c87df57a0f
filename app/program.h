// Runs a program of verbs: reads the command line, performs the verb's action, and turns errors into messages.
#pragma once

#include <functional>

#include "app/command_line.h"

namespace supple {

// Runs the verb that the command line names, and turns errors into messages. Returns the exit status: 0 when it is
// done, 1 when the run failed, 2 when the input is wrong, and 130 when it was interrupted.
int run_command_line(int argc, char** argv, const std::function<void(CommandLine&)>& add_verbs);

}  // namespace supple
