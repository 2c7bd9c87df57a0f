// Tells pages, as JSON (docs/live.md), what a live session plays and what becomes of it.
#pragma once

#include <string>
#include <vector>

#include "live/event_log.h"
#include "output/run/profile.h"
#include "scene/replay/live_keys.h"
#include "world/world.h"

namespace supple {

// Describes how a session stands between two frames.
struct PageState {
  bool paused = false;
  double speed = 1;  // of the film, over the clock's
  int frames = 0;    // that the film has
  std::string field = "none";
  bool wireframe = false, marks = false;
  bool keeps_rate = false;
  bool own_view = false;       // whether the page looks through a camera of its own
  std::vector<LiveGrab> pins;  // grabs that hold without a pointer
  std::string grabbed;         // the name of the one that a pointer moves; empty: none
};

class PageEvents {
 public:
  // Both must outlive this object.
  PageEvents(EventLog& log, const World& world) : log_(log), world_(world) {}

  // Tells what is played. record: the file of the replay; empty: none.
  void tell_scene(const std::string& record);
  void tell_state(const PageState& state);
  // Tells the values that have changed since the last call; or all controls, where other values can change than at that
  // call.
  void tell_controls();
  // Tells all that is wrong, where that has changed.
  void tell_words(const std::vector<std::string>& words);
  // Tells of a frame that was made. rate: how fast the film runs, over the speed that is wanted; picture_ms: what
  // drawing and compressing took [ms].
  void tell_frame(const FrameRow& row, double rate, double picture_ms);
  void say(const std::string& text);
  // Tells that no more frames come, and why.
  void tell_end(const std::string& text);

 private:
  EventLog& log_;
  const World& world_;
  std::string words_;              // that were told last, as JSON
  std::vector<LiveKey> controls_;  // the same
};

}  // namespace supple
