// Declares the sections of the report page, one function each, and what they share. Each section simulates, or reads
// back, the states on which it compares solvers.
#pragma once

#include "app/bench/bench.h"
#include "app/bench/comparison.h"
#include "output/pages/report_page.h"

namespace supple {

// table1.cpp
ReportSection bench_table1(const BenchSetting& setting);
// conditioning.cpp
ReportSection bench_table2(const BenchSetting& setting);
// convergence.cpp
ReportSection bench_figure7(const BenchSetting& setting);
ReportSection bench_figure8(const BenchSetting& setting);
ReportSection bench_rivals(const BenchSetting& setting);
ReportSection bench_figure13(const BenchSetting& setting);
ReportSection bench_figure14(const BenchSetting& setting);
ReportSection bench_figure15(const BenchSetting& setting);
ReportSection bench_figure16(const BenchSetting& setting);
ReportSection bench_figure17(const BenchSetting& setting);
// stability.cpp
ReportSection bench_figure10(const BenchSetting& setting);
// stability_matrix.cpp
ReportSection bench_stability(const BenchSetting& setting);
// all_states.cpp
ReportSection bench_profiles(const BenchSetting& setting);
ReportSection bench_scenes(const BenchSetting& setting);
ReportSection bench_minima(const BenchSetting& setting);
// studies.cpp
ReportSection bench_sweeps(const BenchSetting& setting);
ReportSection bench_substeps(const BenchSetting& setting);
ReportSection bench_hanging(const BenchSetting& setting);
// turning.cpp
ReportSection bench_turning(const BenchSetting& setting);
// engineering.cpp
ReportSection bench_ablation(const BenchSetting& setting);
ReportSection bench_contact(const BenchSetting& setting);
// touching.cpp
ReportSection bench_touching(const BenchSetting& setting);
// matrix.cpp
ReportSection bench_matrix(const BenchSetting& setting);
// scaling.cpp
ReportSection bench_scaling(const BenchSetting& setting);
// roofline.cpp
ReportSection bench_roofline(const BenchSetting& setting);

// Holds what was counted in a film that is played with ten iterations a step.
struct PlayedFilm {
  double renewals = 0;                  // renewals of the matrix a frame
  double renewal_ms = 0;                // time a frame for renewals, and for examining whether one is due
  std::vector<BenchState> states = {};  // states of the film before the wanted frames
};
// Plays a subject's film. frames: the frames whose states are wanted, ascending.
PlayedFilm play_film(Subject& subject, Threads& threads, DirectionStart start, const std::vector<int>& frames = {});

constexpr int most_vertices = 4000;  // of subjects that are solved to the end in many states

// Writes a vector as scenes have it, "[x, y, z]".
std::string list_text(const Vec3& v);

// Returns all bodies of all scenes that ship, by scene.
std::vector<SubjectChoice> all_subjects();

// Returns the states of a subject before these frames: simulates them, or reads them back from the report's folder.
std::vector<BenchState> states_of(Subject& subject, const std::vector<int>& frames, const BenchSetting& setting);

// Prints on standard error what is measured next.
void say_doing(const BenchSetting& setting, const std::string& what);

// Returns the same choice with a mesh of the paper in the body's place, or nothing where the paper's meshes are not
// available.
std::optional<SubjectChoice> with_paper_mesh(const BenchSetting& setting, const SubjectChoice& choice,
                                             const std::string& mesh);

struct Summary {
  double mean = 0, worst = 0, p95 = 0;
};
Summary summary_of(std::vector<double> values);  // NaN are left out

}  // namespace supple
