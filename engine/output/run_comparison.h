// Two runs held against each other: states, distances of the saved motion, step times, and what was run. Not here:
// words about it (app/compare_verb.cpp).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "output/json_difference.h"
#include "output/run_record.h"

namespace supple {

// How far a body of one run is from the same body of the other.
struct FrameDistance {
  double largest = 0;  // of its vertices [m]
  double rms = 0;      // root of the mean square over its vertices [m]
};

struct BodyComparison {
  std::string name;
  int vertices_a = 0, vertices_b = 0;
  double size = 0;                      // diagonal of the box around it in A's first frame [m]
  std::vector<FrameDistance> distance;  // by frame; empty when the numbers of vertices differ
  int worst_frame = 0;                  // where the largest distance is largest
  std::optional<int> first_difference;  // the first frame whose positions differ
  int saved_a = 0, saved_b = 0;         // frames that the saved motion holds
};

struct RunComparison {
  int frames_a = 0, frames_b = 0, frames = 0;  // whole frames; in both
  std::optional<int> first_difference;         // the first frame whose state_hash differs
  std::vector<double> time_s;                  // by frame
  std::vector<BodyComparison> bodies;          // that both have, in the order of A
  std::vector<std::string> only_a, only_b;     // names of the others
  double step_ms_a = 0, step_ms_b = 0;         // median over all frames but the first [ms]
  std::vector<JsonDifference> differences;     // of run.json, but for how the run itself went

  // The same bodies and frames, all with the same hash.
  bool same_states() const;
  // Whether a body's saved motion differs where the states do not: somebody has changed a file.
  bool only_motion_differs(const BodyComparison& body) const;
  bool same_motion() const;
};

// Throws InputError naming the file: a run without a profile, a point cache that is damaged or holds fewer frames than
// the profile.
RunComparison compare_runs(const RunRecord& a, const RunRecord& b);

}  // namespace supple
