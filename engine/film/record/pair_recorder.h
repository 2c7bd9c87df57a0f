// Notes in the row of each frame how pairs of bodies touched each other, which pairs pass through each other, and which
// pairs that meet are deep in each other (scene/definition/meeting.h). Not here: what is said of them at the end of a
// run (output/run/row_tally.h).
#pragma once

#include <array>
#include <string>
#include <vector>

#include "output/run/frame_rows.h"
#include "scene/building/body_depths.h"
#include "scene/building/body_passings.h"
#include "world/world.h"

namespace supple {

// A depth is expected (PairRow::expected) where one of both bodies says that overlaps are meant, and in bodies that
// overlap at the start of the film, up to the first frame in which their contacts are no deeper than DeepBodies::deep.
// From that frame on, depths of such bodies are also measured by positions, in case that contacts are not found at all.
class PairRecorder {
 public:
  // The world must outlive this object. earlier: the rows of the frames that are not made again; what they tell is not
  // told again.
  PairRecorder(const World& world, const FrameRows& earlier);

  // Adds the pairs to the row of the frame whose steps were made last.
  void record(FrameRow& row);

 private:
  using Names = std::array<std::string, 2>;
  struct Overlap {
    std::size_t a, b;
    Names names;
  };

  Names names(std::size_t a, std::size_t b) const;
  bool is_meant(std::size_t a, std::size_t b) const;
  bool is_coming_apart(const Names& names) const;
  void leave_out_known(const std::vector<Names>& met, const std::vector<Names>& deep);
  void note_touches(FrameRow& row);
  void note_who_came_apart(const FrameRow& row);
  void find_crossed(FrameRow& row);
  void find_passings(const std::vector<Positions>& points, FrameRow& row);
  void find_deep(const std::vector<Positions>& points, FrameRow& row);

  const World& world_;
  BodyPassings passings_;              // finds pairs that no earlier frame has had
  DeepBodies deep_;                    // does the same
  std::vector<Overlap> coming_apart_;  // pairs that overlapped at the start and have been deep in each other since
};

}  // namespace supple
