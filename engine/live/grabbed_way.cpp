#include "live/grabbed_way.h"

#include "scene/definition/keyed_motion.h"

namespace supple {
namespace {

// The pointer is taken to go on for this many frames. Hands turn within a tenth of a second.
constexpr int frames_ahead = 4;

}  // namespace

Vec3 GrabbedWay::planned_at(double time) const {
  KeyedMotion motion;
  motion.keys = keys_;
  motion.ease = Ease::linear;
  return motion.at(time).translation();
}

std::optional<std::vector<MotionKey>> GrabbedWay::follow(double end, double step, const Vec3& move) {
  const Vec3 velocity = (move - last_move_) / step;
  last_move_ = move;
  if ((planned_at(end) - move).norm() <= tolerance_) return std::nullopt;
  const Vec3 from = planned_at(end - step), way = move - from;
  const bool is_far = way.norm() > furthest_;
  const Vec3 next = is_far ? Vec3(from + furthest_ * way.normalized()) : move;
  keys_ = {{end, next}};
  if (!is_far && velocity.norm() * step > tolerance_)
    keys_.push_back({end + frames_ahead * step, next + frames_ahead * step * velocity});
  return keys_;
}

}  // namespace supple
