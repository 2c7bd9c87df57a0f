// Compares two runs: their states, the distances between their saved motions, step times, and what was run. Not here:
// the text about it (app/compare_verb.cpp).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "output/run/json_difference.h"
#include "output/run/run_record.h"

namespace supple {

// Tells how far a body of one run is from the same body of the other.
struct FrameDistance {
  double largest = 0;  // of its vertices [m]
  double rms = 0;      // root of the mean square over its vertices [m]
};

struct BodyComparison {
  std::string name;
  int vertices_a = 0, vertices_b = 0;
  double size = 0;                      // diagonal of the box around it in A's first frame [m]
  std::vector<FrameDistance> distance;  // by frame; empty when the numbers of vertices differ
  int worst_frame = 0;                  // the frame with the largest distance of all
  std::optional<int> first_difference;  // the first frame whose positions differ
  int saved_a = 0, saved_b = 0;         // frames that the saved motion holds
  double step_ms_a = 0, step_ms_b = 0;  // median of its steps over all frames but the first [ms]
};

struct RunComparison {
  int frames_a = 0, frames_b = 0, frames = 0;  // numbers of whole frames: of A, of B, in both
  std::optional<int> first_difference;         // the first frame whose state_hash differs
  std::vector<double> time_s;                  // by frame
  std::vector<BodyComparison> bodies;          // that both have, in the order of A
  std::vector<std::string> only_a, only_b;     // names of the others
  double step_ms_a = 0, step_ms_b = 0;         // of all bodies, median over all frames but the first [ms]
  std::vector<JsonDifference> differences;     // of run.json, but for how the run itself went

  // Tells whether both runs have the same bodies and frames, all with the same hash.
  bool same_states() const;
  // Tells whether a body's saved motion differs where the states do not, which means that a file was changed.
  bool only_motion_differs(const BodyComparison& body) const;
  // Tells whether both runs have the same bodies, all with the same saved motion (single precision) in as many frames.
  bool same_motion() const;
};

// Throws InputError with the name of the file when a run has no profile, or when a point cache is damaged or holds
// fewer frames than the profile.
RunComparison compare_runs(const RunRecord& a, const RunRecord& b);

}  // namespace supple
