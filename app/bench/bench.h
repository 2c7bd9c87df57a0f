// Runs the benchmarks of `supple bench`, each of which makes one section of the report page. app/bench_main.cpp
// includes this header and names.h, and nothing else of app/bench.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/threads.h"

namespace supple {

// Holds the setting that every benchmark is given.
struct BenchSetting {
  std::filesystem::path out;                          // folder of the report
  std::optional<std::filesystem::path> paper_meshes;  // folder with the paper's meshes
  Threads* threads = nullptr;                         // of the solvers
  bool quiet = true;                                  // whether nothing is said of what is being measured
};

// Runs the named benchmarks in order, writes the page after each, and skips those that an earlier call with the same
// program and options has finished. fresh: whether these are run again. Returns the exit status.
int run_benchmarks(const std::vector<std::string>& names, const BenchSetting& setting, bool fresh);

}  // namespace supple
