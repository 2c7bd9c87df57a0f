// Plays hard cases of bodies that meet (meeting_cases.h), and makes the tables of how they end. What a run tells of
// itself comes from the recorders and the tally of a film. Whether it kept its rules is seen from its states alone, so
// that runs that go wrong without a warning are found. docs/bench.md has the rules.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "app/bench/meeting_cases.h"
#include "app/bench/stability_matrix.h"
#include "output/pages/report_table.h"

namespace supple {

struct BenchSetting;  // bench.h

// Says how a run ended. All but the warnings comes from positions and velocities at the ends of frames.
struct MeetingOutcome {
  bool finite = true;
  double gained = 0;   // energy that the bodies together gained from nothing, over what they exchanged: the worst
  std::string passed;  // names two bodies that are no longer in their order; empty: all are
  double deepest = 0;  // how deep bodies were in each other, over the smaller one's size: the deepest of all frames
  double depth_at_end = 0;
  bool crossed_at_end = false;        // edges of a body cross faces of another, with no vertex inside
  bool started_inside = false;        // bodies overlapped before the first frame
  int inverted = 0, collapsed = 0;    // elements, at the end
  double speed = 0;                   // of the fastest body at the end, in its sizes a second: root of the mean square
  double trials = 0;                  // evaluations a frame
  std::vector<std::string> warnings;  // what a film of the scene would say at its end
  std::string failure;                // the rule that was broken; empty: passed

  bool passed_all() const { return failure.empty(); }
  bool is_silent() const { return !passed_all() && warnings.empty(); }
};

// Plays all runs of a case with one material. folder: a folder of a run, which the recorders need; what it holds does
// not matter afterwards. Throws BenchInterrupted between two runs when a signal has come.
std::vector<MeetingOutcome> run_meeting(const MeetingCase& meeting, const NamedMaterial& material, int substeps,
                                        const std::filesystem::path& folder, Threads& threads);

// Counts runs, those that broke a rule, and those that broke one without a warning.
struct MeetingCounts {
  int runs = 0, failed = 0, silent = 0;
};

struct MeetingTables {
  ReportTable ends, figures;
  MeetingCounts counts;
};

// Plays all cases with all of their materials and substeps (meeting_tables.cpp).
MeetingTables meeting_tables(const BenchSetting& setting);

}  // namespace supple
