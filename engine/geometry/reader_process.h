// Runs a reader as a child process that may crash, hang or write without end. Not here: what its bytes mean.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace supple {

struct ReaderLimits {
  double seconds = 120;                      // of wall time
  std::size_t bytes = std::size_t(1) << 30;  // of output
};

// What `program file` writes to its standard output. The child is gone when this returns or throws. Throws InputError
// about `file`: the program cannot be run, crashed, failed, took too long or wrote too much.
std::string run_reader(const std::filesystem::path& program, const std::filesystem::path& file,
                       const ReaderLimits& limits = {});

}  // namespace supple
