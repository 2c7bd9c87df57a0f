// Makes the way of a handle that follows a pointer, as few keys. The keys are fitted while the pointer moves, and the
// handle goes the fitted way, so that a replay with these keys has the same bits.
#pragma once

#include <optional>
#include <vector>

#include "base/types.h"
#include "scene/definition/keyed_motion.h"

namespace supple {

// At the beginning of each frame, the pointer says where the handle shall be at the frame's end. As long as the way
// that was planned comes there, within the tolerance, it stays as it is. Otherwise a new way is planned: in this frame
// to where the pointer is, from there on as fast as the pointer moved, and after a while no further.
class GrabbedWay {
 public:
  // tolerance: how far the handle may be from the pointer [m]. furthest: how far it goes in one frame [m].
  GrabbedWay(double tolerance, double furthest) : tolerance_(tolerance), furthest_(furthest) {}

  // Returns the keys of a new way, which begins with this frame; nothing where the planned one goes on. end: the time
  // at which the frame ends; step: its length [s]. move: where the pointer is, from where the handle took hold [m].
  std::optional<std::vector<MotionKey>> follow(double end, double step, const Vec3& move);

 private:
  Vec3 planned_at(double time) const;

  double tolerance_, furthest_;
  std::vector<MotionKey> keys_;    // of the planned way; empty: it stays where it took hold
  Vec3 last_move_ = Vec3::Zero();  // of the pointer, one frame before
};

}  // namespace supple
