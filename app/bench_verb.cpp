#include <fmt/core.h>

#include <CLI/CLI.hpp>
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

void add_bench(CLI::App& app, Action& action) {
  auto options = std::make_shared<BenchOptions>();
  CLI::App* verb = app.add_subcommand("bench", "Solvers compared on the same states: the paper's tables and figures.");
  std::vector<std::string> names = {"all"};
  std::string list = "Benchmarks:\n  all          every one\n";
  for (const Benchmark& b : benchmarks()) {
    names.push_back(b.name);
    list += fmt::format("  {:12} {}\n", b.name, b.meaning);
  }
  verb->add_option("NAME", options->name, "one of the benchmarks below, or all")
      ->required()
      ->check(CLI::IsMember(names));
  verb->add_option("--out", options->out, "folder for the report")->capture_default_str();
  verb->add_option("--paper-meshes", options->paper_meshes, "folder with the meshes of the paper (longbar2.mesh ...)");
  verb->add_option("--threads", options->threads, "threads of the solvers")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
  verb->add_flag("--fresh", options->fresh, "make what an earlier call has finished once more");
  verb->add_flag("--quiet", options->quiet, "say nothing but errors");
  verb->footer(list +
               "\nExample: supple bench figure7\nLeaves index.html with CSV, JSON and SVG beside it; bench all goes on "
               "where it stopped.");
  verb->callback([options, &action] { action = [options] { return bench(*options); }; });
}

}  // namespace supple
