#include "app/bench_verb.h"

#include <fmt/core.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/bench/names.h"
#include "base/companion_program.h"
#include "base/error.h"

namespace supple {
namespace {

// Starts supple-bench with the words of this line, in the place of this process.
int become_bench_program(const std::vector<std::string>& words) {
  const std::optional<std::filesystem::path> program = companion_program("supple-bench");
  if (!program) throw RunError("bench: its program, supple-bench, has not been built: cmake --build build/release");
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  ::execv(program->c_str(), arguments.data());
  throw RunError(fmt::format("{}: cannot be started: {}", program->string(), std::strerror(errno)));
}

}  // namespace

void describe_bench(CommandLine& line, std::function<int(const BenchOptions&)> bench) {
  auto options = std::make_shared<BenchOptions>();
  Verb verb = line.verb("bench", "Solvers compared on the same states: the paper's tables and figures.");
  std::vector<std::string> names = {"all"};
  std::string list = "Benchmarks:\n  all          every one\n";
  for (const BenchmarkName& b : benchmark_names) {
    names.emplace_back(b.name);
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
  verb.runs([options, bench] { return bench(*options); });
}

void add_bench(CommandLine& line) {
  describe_bench(line, [&line](const BenchOptions&) { return become_bench_program(line.words()); });
}

}  // namespace supple
