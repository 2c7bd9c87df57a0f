// The program supple-bench does the work of `supple bench`, which starts it.
#include <filesystem>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "app/bench/bench.h"
#include "app/bench/names.h"
#include "app/bench_verb.h"
#include "app/program.h"
#include "base/error.h"
#include "base/interrupts.h"
#include "base/threads.h"

namespace supple {
namespace {

int bench(const BenchOptions& options) {
  std::vector<std::string> names;
  for (const BenchmarkName& b : benchmark_names) {
    if (options.name == "all" || options.name == b.name) names.emplace_back(b.name);
  }
  Threads threads(options.threads);
  BenchSetting setting{options.out, std::nullopt, &threads, options.quiet};
  if (!options.paper_meshes.empty()) {
    std::error_code error;
    if (!std::filesystem::exists(std::filesystem::path(options.paper_meshes) / "longbar2.mesh", error))
      throw InputError(options.paper_meshes, "no longbar2.mesh here: this is not the folder of the paper's meshes");
    setting.paper_meshes = options.paper_meshes;
  }
  catch_interrupts();
  return run_benchmarks(names, setting, options.fresh);
}

}  // namespace
}  // namespace supple

int main(int argc, char** argv) {
  return supple::run_command_line(argc, argv,
                                  [](supple::CommandLine& line) { supple::describe_bench(line, supple::bench); });
}
