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

// Describes the contact of a body with one collider at the end of a frame.
struct ColliderRow {
  std::string name;
  double penetration = 0;  // the surface's largest depth inside it, over the body's size
  double force = 0;        // size of its force on the body [N]
  double far_side = 0;     // how far parts of the surface that it cuts off reach out of it on its far side [m]
};

// Describes the contacts of a body in a frame; it is absent where the scene has no colliders. Contacts of all kinds
// count: with colliders, with other bodies, and of the body with itself. Depths are those in colliders alone. Where the
// steps of several bodies are made together, changes and cycles are those of all of them.
struct ContactRow {
  double collide_ms = 0;   // time to find contacts
  int contacts = 0;        // contacts in force at the end of the frame
  int changes = 0;         // contacts that came or went, over the frame's iterations
  int cycles = 0;          // iterations that restored the contacts of the one before last
  double penetration = 0;  // the surface's largest depth inside a collider, over the body's size
  std::vector<ColliderRow> colliders = {};
};

// Describes how two bodies touched each other at the end of a frame, or how one touched itself.
struct PairRow {
  std::array<std::string, 2> bodies;  // equal where a body touched itself
  int contacts = 0;                   // contacts between them; ContactRow of each body counts those in force again
  double penetration = 0;             // depth of the deepest of these contacts, over the smaller body's size
  double force = 0;                   // size of the force between the bodies [N]
  bool expected = false;              // whether a depth is meant, or is left of an overlap at the start
  bool coming_apart = false;          // whether a depth is left of an overlap at the start, and not meant
};

// Describes two bodies that meet and are deep in each other, as their positions alone show it; or two cloths that cross
// each other, or one that crosses itself.
struct DeepRow {
  std::array<std::string, 2> bodies;
  double share = 0;               // depth over the smaller body's size; 0 where cloths cross
  std::array<double, 3> place{};  // of the deepest vertex [m]
};

// Holds what a body has and what it was given since the film began (sim/measures/energies.h) [J].
struct BalanceRow {
  double total = 0, put_in = 0, from_nothing = 0, held = 0, worked = 0;
  std::optional<double> flowed = {};  // elastic energy that was lost to flow; nothing where the body does not flow

  double exchanged() const { return held + worked; }
};

// Sums up what the steps of a frame know of themselves. Where the steps of several bodies are made together, all of
// these bodies have the same iterations, trials, objective, errors of equation 12 and reason of the end. Each body has
// its share of the times, by vertices, and its own error of motion.
struct StepRow {
  double step_ms = 0, evaluate_ms = 0, solve_ms = 0, lbfgs_ms = 0, matrix_ms = 0, other_ms = 0;
  // Numbers of all iterations, of those among them that finished hard steps, and of points that line searches tried.
  int iterations = 0, newton_iterations = 0, line_search = 0;
  double objective_start = 0, objective_end = 0;   // of the frame's last step [J]
  double error_estimate = 0, motion_estimate = 0;  // of the frame's worst step
  bool unsolved = false;  // a step of the frame did not come near its minimum (base/unsolved_step.h)
  std::string stop_reason;
  std::vector<std::array<int, 2>>
      budget_cuts;  // BudgetCuts (sim/model/budget_cuts.h) by substep; empty without a budget
  bool error_measured = false;
  std::optional<double> error;         // of equation 12; null where g(y) is above its minimum by round-off alone
  std::optional<double> motion_error;  // distance from the solved step, over the motion in that step
  // Whether the reference of both errors converged; if not, they are against the lowest iterate that it found.
  bool reference_converged = true;
};

// Holds what a body shows at the end of a frame, with the steps that moved it.
struct BodyRow : StepRow {
  std::string name;
  double stretch = 0;                           // 99.9th percentile of the largest stretch, weighted by volume
  std::optional<std::array<double, 5>> energy;  // kinetic, elastic, gravitational, springs, contact [J]; when asked for
  std::optional<BalanceRow> balance;            // absent in profiles of earlier versions
  std::optional<int> inverted, collapsed;       // numbers of tetrahedra turned inside out, and without volume
  // How many times as much as the elements the most stretched edge of the drawn skin is stretched; absent where no skin
  // is carried and drawn, or none of its edges is stretched by half.
  std::optional<double> skin_excess;
  std::optional<double> in_picture;  // share of its surface that lies within the picture's borders; where it is drawn
  std::optional<double> jiggle;      // jiggle of the body over its size; only for bodies with a handle
  // The largest difference between a gap in a seam and the gap that is meant there, over the mean length of an edge;
  // only for bodies with seams.
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
  // Pairs of bodies that do not meet, and that pass through each other in this frame for the first time.
  std::vector<std::array<std::string, 2>> passing;
  // Pairs of bodies that meet, and that are deep in each other, or cross, in this frame for the first time.
  std::vector<DeepRow> deep;
  std::vector<PairRow> pairs;  // pairs of bodies that touch each other, and bodies that touch themselves
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

// Returns the warnings at the end of a run: a sentence for each thing that went wrong and did not end the run. They
// tell of energy from nothing, stretched skins, elements that are inverted or without volume at the end, seams that are
// open at the end, states that differ from those of a live session, bodies that pass through each other or are deep in
// each other, depths in colliders and parts on their far sides (penetration_warnings), bodies that are out of pictures
// or cut by their borders, and steps that are unsolved (RowTally::unsolved_warning, with its usual words).
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

// Returns tables for people: the times of the stages, the solver's figures of each body, then the depths and forces of
// bodies at each collider, and of bodies at each other.
std::string profile_table(const std::vector<FrameRow>& rows);

// Returns sentences about bodies at colliders: one where a body's surface was deeper in a collider than 1 % of the
// body's size, and one where a part of a body was on the far side of a collider.
std::vector<std::string> penetration_warnings(const std::vector<FrameRow>& rows);

}  // namespace supple
