// Runs other programs (ffmpeg, gnuplot, supple itself for a part of its work) to their end, without a shell.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace supple {

struct ProgramEnd {
  int status;          // as waitpid gives it
  std::string output;  // the last 4 kB of standard output and standard error
};

// Looks the program up in PATH and runs it with an empty standard input. Returns nothing when it is not installed.
// stop: is asked several times a second; once it returns true, the program gets SIGINT and is still waited for. A
// program that can be stopped does not outlive this process or thread: it gets SIGTERM when that ends, however it ends.
// Several threads may call this.
std::optional<ProgramEnd> run_program(const std::vector<std::string>& words, const std::function<bool()>& stop = {});

// Gives "was ended by signal 9" or "ended with status 1".
std::string how_it_ended(const ProgramEnd& end);

}  // namespace supple
