#include <fmt/core.h>

#include <algorithm>
#include <memory>

#include "app/bench/bench.h"
#include "app/verbs.h"
#include "base/error.h"
#include "base/interrupts.h"

namespace supple {
namespace {

struct BenchOptions {
  std::string name;
  std::string out = "out/bench";
  std::string paper_meshes;
  int threads = 1;
  bool fresh = false, quiet = false;
};

int bench(const BenchOptions& options) {
  std::vector<std::string> names;
  for (const Benchmark& b : benchmarks()) {
    if (options.name == "all" || options.name == b.name) names.push_back(b.name);
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

void add_bench(CommandLine& line) {
  auto options = std::make_shared<BenchOptions>();
  Verb verb = line.verb("bench", "Solvers compared on the same states: the paper's tables and figures.");
  std::vector<std::string> names = {"all"};
  std::string list = "Benchmarks:\n  all          every one\n";
  for (const Benchmark& b : benchmarks()) {
    names.push_back(b.name);
    list += fmt::format("  {:12} {}\n", b.name, b.meaning);
  }
  verb.option("NAME", options->name, "one of the benchmarks below, or all").required().one_of(names);
  verb.option("--out", options->out, "folder for the report").shows_default();
  verb.option("--paper-meshes", options->paper_meshes, "folder with the meshes of the paper (longbar2.mesh ...)");
  verb.option("--threads", options->threads, "threads of the solvers").between(1, 256).shows_default();
  verb.flag("--fresh", options->fresh, "make what an earlier call has finished once more");
  verb.flag("--quiet", options->quiet, "say nothing but errors");
  verb.footer(list +
              "\nExample: supple bench figure7\nLeaves index.html with CSV, JSON and SVG beside it; bench all goes on "
              "where it stopped.");
  verb.runs([options] { return bench(*options); });
}

}  // namespace supple
