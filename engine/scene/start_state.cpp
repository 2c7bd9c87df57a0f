#include "scene/start_state.h"

#include <Eigen/Geometry>
#include <numbers>

#include "base/hash.h"
#include "scene/rotation.h"

namespace supple {

Stretched Stretched::read(const ConfigTable& table) {
  return {table.vector({key, "", "factors along x, y and z about the middle; negative ones turn it inside out"},
                       Vec3(1, 1, 1))};
}

Vec3 Stretched::place(const Vec3& rest, const RestFrame& frame, Dice&) const {
  return frame.center + factors.cwiseProduct(rest - frame.center);
}

Rotated Rotated::read(const ConfigTable& table) {
  return {
      rotation_from_degrees(table.vector({key, "degrees", "about x, then y, then z, around the middle"}, Vec3(0, 0, 0)))
          .toRotationMatrix()};
}

Vec3 Rotated::place(const Vec3& rest, const RestFrame& frame, Dice&) const {
  return frame.center + rotation * (rest - frame.center);
}

Twisted Twisted::read(const ConfigTable& table) {
  return {table.number({key, "degrees", "about the longest axis, from one end to the other"}, 0.0, Range::any())};
}

Vec3 Twisted::place(const Vec3& rest, const RestFrame& frame, Dice&) const {
  int axis = 0;
  const double length = frame.box.extent().maxCoeff(&axis);
  const double share = length > 0 ? (rest - frame.center)[axis] / length : 0;
  const double angle = degrees * std::numbers::pi / 180 * share;
  return frame.center + Eigen::AngleAxisd(angle, Vec3::Unit(axis)) * (rest - frame.center);
}

Random Random::read(const ConfigTable& table) {
  return {table.vector({key, "m", "extent of a box around the middle in which each vertex starts anywhere"},
                       Vec3(1, 1, 1), Range::at_least(0))};
}

Vec3 Random::place(const Vec3&, const RestFrame& frame, Dice& dice) const {
  Vec3 point = frame.center;
  for (int c = 0; c < 3; ++c) point[c] += extent[c] * dice.between(-0.5, 0.5);
  return point;
}

Flattened Flattened::read(const ConfigTable& table) {
  const std::string onto = table.choice({key, "", "onto a level plane, a line along x or a point, through the middle"},
                                        "plane", {"plane", "line", "point"});
  return {onto == "plane" ? Vec3(1, 0, 1) : onto == "line" ? Vec3(1, 0, 0) : Vec3(0, 0, 0)};
}

Vec3 Flattened::place(const Vec3& rest, const RestFrame& frame, Dice&) const {
  return frame.center + kept.cwiseProduct(rest - frame.center);
}

namespace {

template <class S>
void read_one(const ConfigTable& table, int& given, StartDef& start) {
  if constexpr (requires { S::read(table); }) {
    if (!table.has(S::key)) return;
    ++given;
    start = S::read(table);
  }
}

template <std::size_t... I>
int read_each(const ConfigTable& table, StartDef& start, std::index_sequence<I...>) {
  int given = 0;
  (read_one<std::variant_alternative_t<I, StartDef>>(table, given, start), ...);
  return given;
}

}  // namespace

StartDef read_start(const ConfigTable& body) {
  StartDef start = AtRest{};
  const auto table = body.table({"start", "", "where it starts, if not at rest: exactly one of the keys below"});
  if (!table) return start;
  if (read_each(*table, start, std::make_index_sequence<std::variant_size_v<StartDef>>()) != 1)
    table->complain("a start is exactly one of stretch, turn_deg, twist_deg, random or flatten");
  return start;
}

Positions start_positions(const StartDef& start, const Positions& rest, std::uint64_t seed, const std::string& body) {
  RestFrame frame{bounds_of(rest), Vec3::Zero()};
  frame.center = frame.box.center();
  Dice dice(hash_bytes(body.data(), body.size(), seed));
  Positions placed(rest.rows(), 3);
  for (Eigen::Index v = 0; v < rest.rows(); ++v) {
    placed.row(v) = std::visit([&](const auto& s) { return s.place(rest.row(v), frame, dice); }, start);
  }
  return placed;
}

}  // namespace supple
