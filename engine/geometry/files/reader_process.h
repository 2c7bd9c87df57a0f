// Runs a reader as a child process that may crash, hang or write without end. What its bytes mean is decided elsewhere
// (surface_file.h).
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace supple {

struct ReaderLimits {
  double seconds = 120;                      // of wall time
  std::size_t bytes = std::size_t(1) << 30;  // of output
};

// Returns what `program file`, or `program mode file` where there is a mode, writes to its standard output. The child
// has ended when this returns or throws. Throws InputError about `file` when the program cannot be run, crashed,
// failed, took too long or wrote too much.
std::string run_reader(const std::filesystem::path& program, const std::filesystem::path& file,
                       const ReaderLimits& limits = {}, const std::string& mode = "");

}  // namespace supple
