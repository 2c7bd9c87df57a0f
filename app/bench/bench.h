// The benchmarks of `supple bench`: each makes one section of the report page from states that it plays or finds.
#pragma once

#include <optional>

#include "app/bench/contest.h"
#include "output/report_page.h"

namespace supple {

// What every benchmark gets.
struct BenchSetting {
  std::filesystem::path out;                          // folder of the report
  std::optional<std::filesystem::path> paper_meshes;  // folder with the paper's meshes
  Threads* threads = nullptr;                         // of the solvers
  bool quiet = true;                                  // no word of what is being measured

  std::filesystem::path states() const { return out / "states"; }
  std::vector<BenchState> states_of(const Subject& subject, const std::vector<int>& frames) const {
    return supple::states_of(subject, frames, states(), *threads);
  }
  // Tells what comes next, on standard error.
  void doing(const std::string& what) const;

  // The same scene with a mesh of the paper in the body's place, when there are such.
  std::optional<SubjectChoice> with_paper_mesh(const SubjectChoice& choice, const std::string& mesh) const;
};

struct Benchmark {
  std::string name;
  std::string meaning;  // one line
  double minutes;       // about, on two cores of 2023, to tell how much is left
  ReportSection (*run)(const BenchSetting& setting);
};

const std::vector<Benchmark>& benchmarks();

// Runs the named ones in order, writes the page after each, and skips those that an earlier call with the same program
// and options has finished. Returns the exit status.
int run_benchmarks(const std::vector<std::string>& names, const BenchSetting& setting, bool fresh);

// The sections. table1.cpp
ReportSection bench_table1(const BenchSetting& setting);
// conditioning.cpp
ReportSection bench_table2(const BenchSetting& setting);
// convergence.cpp
ReportSection bench_figure7(const BenchSetting& setting);
ReportSection bench_figure8(const BenchSetting& setting);
ReportSection bench_figure13(const BenchSetting& setting);
ReportSection bench_figure14(const BenchSetting& setting);
ReportSection bench_figure15(const BenchSetting& setting);
ReportSection bench_figure16(const BenchSetting& setting);
ReportSection bench_figure17(const BenchSetting& setting);
// stability.cpp
ReportSection bench_figure10(const BenchSetting& setting);
// all_states.cpp
ReportSection bench_profiles(const BenchSetting& setting);
ReportSection bench_scenes(const BenchSetting& setting);
ReportSection bench_minima(const BenchSetting& setting);
// studies.cpp
ReportSection bench_sweeps(const BenchSetting& setting);
ReportSection bench_substeps(const BenchSetting& setting);
ReportSection bench_hanging(const BenchSetting& setting);
// engineering.cpp
ReportSection bench_ablation(const BenchSetting& setting);
ReportSection bench_contact(const BenchSetting& setting);

// "12.3 (paper 49.2)" and the like are made by tables; these are what all share.
struct Summary {
  double mean = 0, worst = 0, p95 = 0;
};
Summary summary_of(std::vector<double> values);  // NaN are left out

}  // namespace supple
