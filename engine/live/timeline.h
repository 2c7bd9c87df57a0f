// Remembers what a live session needs to go back to any of its frames: rows, states of some frames, and what was done.
// A frame between two states is found by making those before it again, with all that was done in them.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "output/run/profile.h"
#include "scene/replay/played_session.h"
#include "world/world.h"

namespace supple {

// Describes a deed that a replay repeats. frames: how many frames there were before it.
struct Release {
  std::string body, handle;
};
struct Done {
  int frames;
  std::variant<TimedChange, LiveGrab, Release> what;
};

class Timeline {
 public:
  // Begins with a world before its first frame.
  explicit Timeline(const World& world);

  // Adds a frame that was made, and keeps the state after it where one is due.
  void add(FrameRow row, const World& world);
  void add(Done done) { done_.push_back(std::move(done)); }

  // Returns the last state that is kept with at most so many frames before it. Its edits are those that were in force.
  WorldState state_before(int frames, const LiveEdits& all) const;
  // Forgets all frames but the first ones, and what was done after them. The world is at a state of this timeline:
  // makes the frames that are missing, with all that was done in them. Throws RunError where a step fails.
  void go_on_to(int frames, World& world);

  std::size_t deeds() const { return done_.size(); }
  const std::vector<FrameRow>& rows() const { return rows_; }
  // Returns what the replay of these frames notes of them.
  PlayedSession played() const;

 private:
  void redo(const Done& done, World& world) const;
  void thin_out();

  std::vector<FrameRow> rows_;      // of all frames
  std::vector<WorldState> states_;  // of some of them, in their order, without edits
  std::vector<Done> done_;          // in its order
  int every_ = 10;                  // frames between two states that are kept
  std::size_t bytes_ = 0;           // of a state
};

}  // namespace supple
