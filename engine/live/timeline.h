// Remembers what a live session needs to go back to any of its frames: states of some frames, what was done, and where
// budgets of time ended steps. A frame between two states is found by making the frames from the earlier state on
// again, with all that was done in them.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <variant>
#include <vector>

#include "output/run/profile.h"
#include "scene/replay/played_session.h"
#include "world/world.h"

namespace supple {

// Describes the end of a grab.
struct Release {
  std::string body, handle;
};
// Describes an edit that a replay repeats.
struct TimedEdit {
  int frames;  // how many there were before it
  std::variant<TimedChange, LiveGrab, Release> what;
};

class Timeline {
 public:
  // Begins with a world before its first frame.
  explicit Timeline(const World& world);

  // Adds the frame that the world made last, and keeps the state after it where one is due.
  void add(const FrameRow& row, const World& world);
  void add(TimedEdit edit) { edits_.push_back(std::move(edit)); }

  // Returns the last state that is kept with at most so many frames before it. Its edits are those of `all`, the
  // world's edits, that were made before it; grabs that were released later hold in them.
  WorldState state_before(int frames, const LiveEdits& all) const;
  // Makes frames of this timeline again, from the one that the world is at, with all that was done in them. Returns
  // false where `stops` said so between two frames. Throws RunError where a step fails.
  bool remake(int frames, World& world, const std::function<bool()>& stops) const;
  // Forgets all frames but the first ones, and what was done after them.
  void cut(int frames);

  int frames() const { return int(played_.hashes.size()); }
  std::size_t edits() const { return edits_.size(); }
  // Returns what the replay of these frames notes of them.
  const PlayedSession& played() const { return played_; }

 private:
  void redo(const TimedEdit& edit, World& world) const;
  void thin_out();

  PlayedSession played_;            // of all frames
  std::vector<WorldState> states_;  // of some of them, in their order, without edits
  std::vector<TimedEdit> edits_;    // in their order
  int every_ = 10;                  // frames between two states that are kept
  std::size_t bytes_ = 0;           // of the largest state
};

}  // namespace supple
