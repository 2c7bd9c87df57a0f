#include "app/bench/sections.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>
#include <thread>

#include "app/bench/names.h"
#include "app/bench/section_file.h"
#include "base/console.h"
#include "base/error.h"
#include "base/hash.h"
#include "base/interrupts.h"
#include "base/text.h"
#include "base/timing.h"
#include "base/variants.h"
#include "output/run/run_folder.h"

namespace supple {

std::vector<BenchState> states_of(Subject& subject, const std::vector<int>& frames, const BenchSetting& setting) {
  return states_of(subject, frames, setting.out / "states", *setting.threads);
}

std::optional<SubjectChoice> with_paper_mesh(const BenchSetting& setting, const SubjectChoice& choice,
                                             const std::string& mesh) {
  if (!setting.paper_meshes) return std::nullopt;
  SubjectChoice changed = choice;
  changed.settings.push_back(fmt::format("body.{}.mesh={}", choice.body, (*setting.paper_meshes / mesh).string()));
  return changed;
}

void say_doing(const BenchSetting& setting, const std::string& what) {
  if (!setting.quiet) say(stderr, fmt::format("  {}\n", what));
}

Summary summary_of(std::vector<double> values) {
  Summary summary;
  std::erase_if(values, [](double v) { return std::isnan(v); });
  if (values.empty()) return {std::nan(""), std::nan(""), std::nan("")};
  std::sort(values.begin(), values.end());
  for (const double v : values) summary.mean += v / static_cast<double>(values.size());
  summary.worst = values.back();
  const auto rank = static_cast<std::size_t>(std::ceil(0.95 * static_cast<double>(values.size())));
  summary.p95 = values[std::max<std::size_t>(rank, 1) - 1];
  return summary;
}

namespace {

// Pairs each name with the function that makes its section.
struct NamedSection {
  std::string_view name;
  ReportSection (*run)(const BenchSetting& setting);
};
constexpr auto sections_by_name = std::to_array<NamedSection>({
    {"table1", bench_table1},     {"table2", bench_table2},     {"figure7", bench_figure7},
    {"figure8", bench_figure8},   {"figure10", bench_figure10}, {"stability", bench_stability},
    {"figure13", bench_figure13}, {"figure14", bench_figure14}, {"figure15", bench_figure15},
    {"figure16", bench_figure16}, {"figure17", bench_figure17}, {"rivals", bench_rivals},
    {"scenes", bench_scenes},     {"profiles", bench_profiles}, {"minima", bench_minima},
    {"sweeps", bench_sweeps},     {"substeps", bench_substeps}, {"hanging", bench_hanging},
    {"turning", bench_turning},   {"ablation", bench_ablation}, {"contact", bench_contact},
    {"touching", bench_touching}, {"matrix", bench_matrix},     {"scaling", bench_scaling},
    {"roofline", bench_roofline},
});
static_assert(std::ranges::equal(sections_by_name, benchmark_names, {}, &NamedSection::name, &BenchmarkName::name),
              "every benchmark that is offered has a section, in the same order");

// Returns all that a finished section depends on. A section that was made with other values is made again.
std::string fingerprint(const BenchSetting& setting) {
  return fmt::format("{}; {}; {}; {}; {} threads; {}; paper meshes: {}", hash_text_form(program_identity()),
                     program_version(), build_flags(), variant_name(best_variant()), setting.threads->count(),
                     cpu_name(), setting.paper_meshes ? "yes" : "no");
}

ReportPage page_of(const BenchSetting& setting, std::vector<ReportSection> sections) {
  ReportPage page;
  page.title = "Speed against error";
  page.lead =
      "Quasi-Newton steps after Liu, Bouaziz and Kavan 2017, and what they are compared with, on the same states in "
      "one program. The paper's numbers stand beside ours. All methods share first iterate, line search, stopping and "
      "the search for contacts; constant factorisations and patterns are made outside of what is timed. Where bodies "
      "touch, ours, Projective Dynamics, Chebyshev's method and ADMM correct their directions for contacts, Newton's "
      "and vertex block descent have them in their matrices, and L-BFGS from other matrices learns of them from its "
      "pairs alone.";
  page.facts = {{"processor", cpu_name()},
                {"program", program_version()},
                {"build", build_flags()},
                {"kernels", variant_name(best_variant())},
                {"threads of the solver", std::to_string(setting.threads->count())},
                {"paper's meshes", setting.paper_meshes ? "yes, where a table or figure says so" : "not given"}};
  page.sections = std::move(sections);
  return page;
}

}  // namespace

int run_benchmarks(const std::vector<std::string>& names, const BenchSetting& setting, bool fresh) {
  const bool quiet = setting.quiet;
  std::filesystem::create_directories(setting.out / "sections");
  const std::string made_with = fingerprint(setting);
  std::vector<ReportSection> sections;
  double left = 0, expected = 0, spent = 0;
  const auto wanted = [&](const BenchmarkName& b) {
    return std::find(names.begin(), names.end(), b.name) != names.end();
  };
  for (const BenchmarkName& b : benchmark_names) left += wanted(b) ? b.minutes : 0;
  std::size_t number = 0;
  for (std::size_t i = 0; i < benchmark_names.size(); ++i) {
    const BenchmarkName& b = benchmark_names[i];
    const std::filesystem::path file = setting.out / "sections" / fmt::format("{}.json", b.name);
    std::optional<ReportSection> section;
    if (!fresh || !wanted(b)) section = read_section(file, made_with);
    if (!wanted(b)) {
      if (section) sections.push_back(std::move(*section));  // a section of an earlier call, which the page keeps
      continue;
    }
    ++number;
    if (section) {
      if (!quiet) say(stderr, fmt::format("{} ({} of {}) was finished before\n", b.name, number, names.size()));
    } else {
      const double pace = expected > 0 ? spent / expected : 1;
      if (!quiet)
        say(stderr, fmt::format("{} ({} of {}): {}; about {} left\n", b.name, number, names.size(), b.meaning,
                                duration_text(60 * left * pace)));
      const Stopwatch watch;
      try {
        section = sections_by_name[i].run(setting);
      } catch (const BenchInterrupted&) {
        if (!quiet) say(stderr, "interrupted; what is finished is kept\n");
        return 130;
      }
      spent += watch.elapsed_ms() / 60000;
      expected += b.minutes;
      write_section(*section, made_with, file);
    }
    left -= b.minutes;
    sections.push_back(std::move(*section));
    for (const std::string& missing : write_page(page_of(setting, sections), setting.out)) {
      if (!quiet) say(stderr, missing + "\n");
    }
    if (interrupted()) return 130;
  }
  if (!quiet) say(stdout, fmt::format("  page     {}\n", (setting.out / "index.html").string()));
  return 0;
}

}  // namespace supple
