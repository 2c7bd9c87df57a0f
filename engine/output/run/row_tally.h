// Sums up the rows of a run as they pass by, so that no more of them need be in memory than one: distributions of
// times, what went wrong, and tables for people. Of each frame it keeps the few numbers that percentiles need. The
// sentences of the warnings at a run's end are written in row_tally.cpp.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "output/run/profile.h"
#include "output/run/verdict.h"

namespace supple {

// The energy from nothing over the exchanged energy above which a run warns.
inline constexpr double much_energy = 0.2;

// Tallies one stage of a frame.
struct StageTally {
  std::optional<double> first;  // of the first frame [ms]
  std::vector<double> rest;     // of the others that have it [ms]
  double sum = 0;               // of `rest`
};

// Tallies the figures of one body.
struct BodyTally {
  std::string name;
  std::vector<double> step, collide, errors, motion_errors;
  double trials = 0, iterations = 0, stretch = 0, deepest = 0, estimates = 0, motion_estimates = 0;
  int contacts = 0, frames = 0;
  int unsure_errors = 0;  // frames in which the reference of the errors did not converge
  std::optional<double> jiggle;
  // Energy from nothing: the first frame whose balance has much of it, and the frame whose balance has most; -1: none.
  // Then what was gained from nothing, and what was exchanged, by the latter balance [J].
  int first_gain = -1, worst_gain = -1;
  double gained = 0, exchanged = 0;
  double skin_excess = 0;  // the largest
  int skin_frame = 0;
  // Numbers of frames that were drawn, and of those among them in which the body is out of the picture, and in which
  // the picture's border cuts it.
  int drawn = 0, out = 0, cut = 0;
  int first_out = -1, first_cut = -1;
  double least_in_picture = 1;
  int inverted = 0, collapsed = 0;  // in the last frame
  double open_seam = 0;             // in the last frame
};

// Tallies the depths of one body in one collider, and the forces of the collider on the body.
struct TouchTally {
  std::string body, collider;
  double deepest = 0;  // over the body's size
  int deepest_frame = 0, deep_frames = 0;
  double far_side = 0;  // the largest [m]
  int first_far_frame = 0, far_frames = 0;
  double force_sum = 0, largest_force = 0;  // [N]
};

// Tallies the depths of two bodies in each other, or of one in itself, and the forces between them.
struct PairTally {
  std::array<std::string, 2> bodies;
  double deepest = 0;  // over the smaller body's size
  int deepest_frame = 0;
  double unexpected = 0;  // the deepest of those depths that are not expected (PairRow)
  int unexpected_frame = 0, deep_frames = 0;
  double left = 0;      // depth left of an overlap at the start, in the last row that shows the bodies coming apart
  int left_frame = -1;  // the frame of that row
  double force_sum = 0, largest_force = 0;  // [N]
};

// Tells when two bodies that meet were first deep in each other.
struct DeepTally {
  DeepRow found;
  int frame;
};

// Tells since when two bodies that do not meet pass through each other.
struct PassingTally {
  std::array<std::string, 2> bodies;
  int frame;
};

// A body's frame of which a step did not come near its solution, by the solver's own estimates.
struct UnsolvedStep {
  int frame;
  std::string body;
  double error_estimate, motion_estimate;
  double trials;  // of the line search, an iteration
};

// Tells what the warning about unsolved steps leaves out, and how it ends.
struct UnsolvedWords {
  std::vector<std::string> meant = {};  // the names of the bodies that say that their unsolved steps are meant
  // By name of a body: the option that gives it more iterations. Where no options are known, the warning names the key.
  std::map<std::string, std::string> options = {};
};

class RowTally {
 public:
  RowTally() = default;
  explicit RowTally(const std::vector<FrameRow>& rows) {
    for (const FrameRow& row : rows) add(row);
  }

  // Adds the row of a frame. Rows come in the order of their frames.
  void add(const FrameRow& row);
  // Adds a warning that was said when the film began. The warnings in profile.json and in the result of --json begin
  // with such remarks.
  void remark(std::string warning) { remarks_.push_back(std::move(warning)); }
  const std::vector<std::string>& remarks() const { return remarks_; }
  void set_unsolved_words(UnsolvedWords words) { unsolved_words_ = std::move(words); }

  int frames() const { return frames_; }
  std::uint64_t last_hash() const { return last_hash_; }  // state_hash of the last row
  const std::vector<UnsolvedStep>& unsolved() const { return unsolved_; }

  // Some of these functions return for the rows that were added what functions elsewhere return for a list of rows:
  // stages() as summarize(), warnings() as warnings_of(), penetration_warnings() as that of profile.h, table() as
  // profile_table() (profile.h); work() as work_of() (verdict.h).
  std::vector<StageSummary> stages() const;
  std::vector<std::string> warnings() const;
  std::vector<std::string> penetration_warnings() const;
  // Tells, a sentence for each pair, which bodies were deeper in each other than they should be.
  std::vector<std::string> pair_warnings() const;
  // Tells which bodies are out of pictures, or cut by their borders.
  std::vector<std::string> missing_in_pictures() const;
  // Returns the sentence that comes last in warnings(): "3 of 400 frames did not come near their solution: ...". It
  // names each body with such steps, how far off its worst one is, and whether that is seen. Empty where there are no
  // such steps, or where all are meant.
  std::string unsolved_warning() const;
  std::string table() const;
  // Says that the film is as the live session played it that wrote the replay; empty where there was no such session,
  // or where the film differs.
  std::string session_text() const;
  FrameWork work(double encoding) const;

 private:
  void add_body(const FrameRow& row, std::size_t body);
  std::string unsure_text() const;
  std::string touch_table() const;
  std::string pair_table() const;

  std::vector<std::string> remarks_;
  int frames_ = 0, last_frame_ = -1;
  // The number of frames that a live session has played, and the first frame that is not as it was there; -1: none.
  int compared_ = 0, first_other_ = -1;
  bool measured_ = false, touching_ = false;
  std::uint64_t last_hash_ = 0;
  StageTally stages_[5];  // in the order of stage_list (row_tally.cpp)
  std::vector<BodyTally> bodies_;
  std::vector<TouchTally> touches_;
  std::vector<PairTally> pairs_;
  std::vector<DeepTally> deep_;
  std::vector<PassingTally> passing_;
  std::vector<UnsolvedStep> unsolved_;
  UnsolvedWords unsolved_words_;
};

}  // namespace supple
