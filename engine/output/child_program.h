// Other programs (ffmpeg, gnuplot, supple itself for a part of its work), run to their end without a shell.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace supple {

struct ProgramEnd {
  int status;          // of waitpid
  std::string output;  // standard output and errors, the last 4 kB
};

// The program is looked up in PATH; its standard input is empty. Nothing when it is not installed. stop: asked several
// times a second; once it says yes the program gets SIGINT, and is still waited for. A program that can be stopped does
// not outlive this process or thread: it gets SIGTERM when that ends, however it ends. Several threads may call this.
std::optional<ProgramEnd> run_program(const std::vector<std::string>& words, const std::function<bool()>& stop = {});

// "was ended by signal 9", "ended with status 1"
std::string how_it_ended(const ProgramEnd& end);

}  // namespace supple
