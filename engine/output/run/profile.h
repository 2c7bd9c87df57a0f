// Holds the times and figures of a run, frame by frame, for profile.json and for a table on the terminal. The rows are
// plain data; the caller fills them in.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "output/files/whole_file.h"

namespace supple {

// Describes the contact with one collider at the end of a frame.
struct ColliderRow {
  std::string name;
  double penetration = 0;  // the surface's largest depth inside it, over the body's size
  double force = 0;        // on the body [N]
  double far_side = 0;     // how far a part of the surface that went through it reaches out beyond it [m]
};

// Describes the contact with colliders; it is absent where a scene has none.
struct ContactRow {
  double collide_ms = 0;
  int contacts = 0;        // vertices in contact at the end of the frame
  int changes = 0;         // vertices that came into contact or left it, over the frame's iterations
  int cycles = 0;          // iterations that restored the contact set of the one before last
  double penetration = 0;  // the surface's largest depth inside a collider, over the body's size
  std::vector<ColliderRow> colliders = {};
};

// Describes how two bodies touched each other at the end of a frame.
struct PairRow {
  std::array<std::string, 2> bodies;
  int contacts = 0;           // points of either body that touch the other
  double penetration = 0;     // of the deepest of them in the other body, over the smaller body's size
  double force = 0;           // between the bodies [N]
  bool expected = false;      // the depth is meant, or the bodies overlapped at the start and are still coming apart
  bool coming_apart = false;  // the second of these, and it is not meant
};

// Describes two bodies that meet and are deep in each other, as their positions alone show it.
struct DeepRow {
  std::array<std::string, 2> bodies;
  double share = 0;               // of the depth in the smaller body's size
  std::array<double, 3> place{};  // of the deepest vertex [m]
};

// Holds what a body has and what it was given since the film began (sim/measures/energies.h) [J].
struct BalanceRow {
  double total = 0, put_in = 0, from_nothing = 0, held = 0, worked = 0;
  std::optional<double> flowed = {};  // elastic energy that was lost to flow; nothing where the body does not flow

  double exchanged() const { return held + worked; }
};

// Holds what the steps of a frame know of themselves, summed up. Bodies whose steps are made together share it.
struct StepRow {
  double step_ms = 0, evaluate_ms = 0, solve_ms = 0, lbfgs_ms = 0, matrix_ms = 0, other_ms = 0;
  int iterations = 0, newton_iterations = 0, line_search = 0;  // the second: of these, those that finished hard steps
  double objective_start = 0, objective_end = 0;               // [J]
  double error_estimate = 0, motion_estimate = 0;              // of the frame's worst step
  bool unsolved = false;  // a step of the frame did not come near its minimum (base/unsolved_step.h)
  std::string stop_reason;
  std::vector<std::array<int, 2>>
      budget_cuts;  // BudgetCuts (sim/model/budget_cuts.h) by substep; empty without a budget
  bool error_measured = false;
  std::optional<double> error;         // equation 12; null where the start is already the minimum to round-off
  std::optional<double> motion_error;  // how far the solved motion is, over the step's own motion
  // False where the reference of the two errors did not converge: they are those against the lowest iterate it found.
  bool reference_converged = true;
};

// Holds what a body shows at the end of a frame, with the steps that moved it.
struct BodyRow : StepRow {
  std::string name;
  double stretch = 0;                           // 99.9th percentile of the largest stretch, weighted by volume
  std::optional<std::array<double, 5>> energy;  // kinetic, elastic, gravitational, springs, contact [J]; when asked for
  std::optional<BalanceRow> balance;            // absent in profiles of earlier versions
  std::optional<int> inverted, collapsed;       // numbers of tetrahedra turned inside out, and without volume
  // How much more the most stretched edge of the drawn skin is stretched than the elements; absent where no skin is
  // carried and drawn, or none of its edges is stretched by half.
  std::optional<double> skin_excess;
  std::optional<double> in_picture;  // share of its surface that lies within the picture's borders; where it is drawn
  std::optional<double> jiggle;      // jiggle of the body over its size; only for bodies with a handle
  // How far two places that a seam joins are apart at most, beside what they are meant to be, over the mean length of
  // an edge; only for bodies with seams.
  std::optional<double> open_seam;
  std::optional<ContactRow> contact;
};

// Holds how long the picture of a frame took.
struct PictureTimes {
  int frame;
  double render_ms;
  std::optional<double> compress_ms;  // only where it became a file
};

struct FrameRow {
  int frame = 0;
  double time_s = 0;
  double step_ms = 0;
  std::optional<double> change_ms;           // time to apply what a replay changes; absent where it changes nothing
  std::optional<double> draw_ms, render_ms;  // absent where nothing is drawn
  std::optional<double> compress_ms;         // of the frame's file; absent without one
  std::uint64_t state_hash = 0;
  std::optional<bool> as_in_session;  // whether the states are those of the live session that wrote the replay
  std::vector<std::array<std::string, 2>> met;  // bodies that pass through each other, first in this frame
  std::vector<DeepRow> deep;                    // bodies that are deep in each other, first in this frame
  std::vector<PairRow> pairs;                   // bodies that touch each other
  std::vector<BodyRow> bodies;
};

struct Distribution {
  double p50 = 0, p95 = 0, p99 = 0, max = 0, mean = 0, total = 0;
};

// Computes nearest-rank percentiles; an empty list gives zeros.
Distribution distribution_of(std::vector<double> values);

// Summarises the stages of a frame that were used, in the order in which they run. The first frame is left out of
// `rest`, because it compiles shaders and warms caches.
struct StageSummary {
  std::string stage;
  double first = 0;
  Distribution rest;
};
std::vector<StageSummary> summarize(const std::vector<FrameRow>& rows);

// Says what went wrong physically and did not end the run, a sentence for each body and kind: energy from nothing,
// elements that are inverted or without volume at the end, bodies that pass through each other or are deep in each
// other, and depths inside colliders (penetration_warnings).
std::vector<std::string> warnings_of(const std::vector<FrameRow>& rows);

class FrameRows;  // frame_rows.h
class RowTally;   // row_tally.h

// Writes rows as text (profile_json.cpp): all rows of a run, in pieces or at once, or one row as a line of its own.
// tally: the tally of the same rows. verdict: the verdict on the whole run (verdict.h); empty: none.
void write_profile(const FrameRows& rows, const RowTally& tally, const std::string& verdict, const TakesText& take);
std::string profile_json(const std::vector<FrameRow>& rows, const std::string& verdict = "");
std::string row_line(const FrameRow& row);

// Reads rows back. Throws InputError naming the file where it cannot be read or is not such a text.
FrameRow row_of_line(const std::string& line, const std::string& source);
std::vector<FrameRow> read_profile(const std::filesystem::path& path);

// Gives a table for people: the stages, then the solver's figures by body, then what each collider did to it, and then
// what bodies did to each other.
std::string profile_table(const std::vector<FrameRow>& rows);

// Tells for each body and collider where the body's surface was deeper inside than it should be.
std::vector<std::string> penetration_warnings(const std::vector<FrameRow>& rows);

}  // namespace supple
