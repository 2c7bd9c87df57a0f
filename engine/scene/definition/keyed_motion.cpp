#include "scene/definition/keyed_motion.h"

#include <algorithm>

#include "scene/definition/rotation.h"

namespace supple {

Eigen::Isometry3d KeyedMotion::at(double time) const {
  Vec3 move = Vec3::Zero();
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
  if (!keys.empty()) {
    const auto after = std::find_if(keys.begin(), keys.end(), [time](const MotionKey& key) { return key.time > time; });
    if (after == keys.begin() || after == keys.end()) {
      const MotionKey& key = after == keys.end() ? keys.back() : keys.front();
      move = key.move;
      turn = rotation_from_degrees(key.turn_deg);
    } else {
      const MotionKey& before = *(after - 1);
      double s = (time - before.time) / (after->time - before.time);
      if (ease == Ease::smooth) s = s * s * (3 - 2 * s);
      move = before.move + s * (after->move - before.move);
      // Angles are interpolated, not rotations, so a turn by 360 degrees is a full turn.
      turn = rotation_from_degrees(before.turn_deg + s * (after->turn_deg - before.turn_deg));
    }
  }
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translate(center + move).rotate(turn).translate(-center);
  return pose;
}

}  // namespace supple
