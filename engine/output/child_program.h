// Programs of others (ffmpeg, gnuplot), run to their end without a shell.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace supple {

struct ProgramEnd {
  int status;          // of waitpid
  std::string output;  // standard output and errors, the last 4 kB
};

// The program is looked up in PATH; its standard input is empty. Nothing when it is not installed.
std::optional<ProgramEnd> run_program(const std::vector<std::string>& words);

// "was ended by signal 9", "ended with status 1"
std::string how_it_ended(const ProgramEnd& end);

}  // namespace supple
