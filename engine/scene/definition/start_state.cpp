#include "scene/definition/start_state.h"

#include <Eigen/Geometry>
#include <numbers>

#include "base/hash.h"

namespace supple {

Vec3 Stretched::place(const Vec3& rest, const RestFrame& frame, UniformNumbers&) const {
  return frame.center + factors.cwiseProduct(rest - frame.center);
}

Vec3 Rotated::place(const Vec3& rest, const RestFrame& frame, UniformNumbers&) const {
  return frame.center + rotation * (rest - frame.center);
}

Vec3 Twisted::place(const Vec3& rest, const RestFrame& frame, UniformNumbers&) const {
  int axis = 0;
  const double length = frame.box.extent().maxCoeff(&axis);
  const double share = length > 0 ? (rest - frame.center)[axis] / length : 0;
  const double angle = degrees * std::numbers::pi / 180 * share;
  return frame.center + Eigen::AngleAxisd(angle, Vec3::Unit(axis)) * (rest - frame.center);
}

Vec3 Random::place(const Vec3&, const RestFrame& frame, UniformNumbers& numbers) const {
  Vec3 point = frame.center;
  for (int c = 0; c < 3; ++c) point[c] += extent[c] * numbers.between(-0.5, 0.5);
  return point;
}

Vec3 Flattened::place(const Vec3& rest, const RestFrame& frame, UniformNumbers&) const {
  return frame.center + kept.cwiseProduct(rest - frame.center);
}

Positions start_positions(const StartDef& start, const Positions& rest, std::uint64_t seed, const std::string& body) {
  RestFrame frame{bounds_of(rest), Vec3::Zero()};
  frame.center = frame.box.center();
  UniformNumbers numbers(hash_bytes(body.data(), body.size(), seed));
  Positions placed(rest.rows(), 3);
  for (Eigen::Index v = 0; v < rest.rows(); ++v) {
    placed.row(v) = std::visit([&](const auto& s) { return s.place(rest.row(v), frame, numbers); }, start);
  }
  return placed;
}

}  // namespace supple
