#include "film/redraw/smooth_motion.h"

#include <algorithm>

namespace supple {
namespace {

// Returns the velocity at a frame, from the ways to it and from it.
Vec3 velocity_at(const Vec3& before, const Vec3& after) {
  const Vec3 mean = 0.5 * (before + after);
  const double most = 3 * std::min(before.norm(), after.norm()), length = mean.norm();
  return length > most ? Vec3(most / length * mean) : mean;
}

}  // namespace

Positions between_frames(const std::array<Positions, 4>& frames, double share) {
  const double s = share, s2 = s * s, s3 = s2 * s;
  Positions result = frames[1];
  for (Eigen::Index v = 0; v < result.rows(); ++v) {
    const Vec3 start = frames[1].row(v), end = frames[2].row(v), way = end - start;
    const Vec3 leaves = velocity_at(start - Vec3(frames[0].row(v)), way);
    const Vec3 arrives = velocity_at(way, Vec3(frames[3].row(v)) - end);
    const Vec3 place = start + (3 * s2 - 2 * s3) * way + (s3 - 2 * s2 + s) * leaves + (s3 - s2) * arrives;
    result.row(v) = place.transpose();
  }
  return result;
}

}  // namespace supple
