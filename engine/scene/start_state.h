// Where a body starts: at rest, or deformed on purpose, to see it recover. Not here: motion from outside (handles).
// A new start state is a struct with a key, read() and place(), and an entry in StartDef.
#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <variant>

#include "base/types.h"
#include "scene/config.h"

namespace supple {

// What a start state is relative to: the body at rest, in its place in the world.
struct RestFrame {
  Bounds box;
  Vec3 center = Vec3::Zero();  // of the box [m]
};

// Uniform numbers that are the same on every machine and library.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : engine_(seed) {}
  double between(double low, double high) {
    return low + (high - low) * 0x1p-53 * static_cast<double>(engine_() >> 11);
  }

 private:
  std::mt19937_64 engine_;
};

struct AtRest {
  static constexpr const char* key = "rest";
  Vec3 place(const Vec3& rest, const RestFrame&, Dice&) const { return rest; }
};

struct Stretched {
  static constexpr const char* key = "stretch";
  Vec3 factors;
  static Stretched read(const ConfigTable& table);
  Vec3 place(const Vec3& rest, const RestFrame& frame, Dice&) const;
};

struct Rotated {
  static constexpr const char* key = "turn_deg";
  Mat3 rotation;
  static Rotated read(const ConfigTable& table);
  Vec3 place(const Vec3& rest, const RestFrame& frame, Dice&) const;
};

struct Twisted {  // about the longest axis of the box, by the angle from end to end
  static constexpr const char* key = "twist_deg";
  double degrees;
  static Twisted read(const ConfigTable& table);
  Vec3 place(const Vec3& rest, const RestFrame& frame, Dice&) const;
};

struct Random {  // every vertex anywhere in a box around the centre
  static constexpr const char* key = "random";
  Vec3 extent;  // [m]
  static Random read(const ConfigTable& table);
  Vec3 place(const Vec3& rest, const RestFrame& frame, Dice& dice) const;
};

struct Flattened {  // onto the ground plane's direction, a line along x, or a point
  static constexpr const char* key = "flatten";
  Vec3 kept;  // 1 for the coordinates that stay
  static Flattened read(const ConfigTable& table);
  Vec3 place(const Vec3& rest, const RestFrame& frame, Dice&) const;
};

using StartDef = std::variant<AtRest, Stretched, Rotated, Twisted, Random, Flattened>;

// The table `start` of a body; rest without it.
StartDef read_start(const ConfigTable& body);

// All points of a body where it starts. The dice follow from the scene's seed and the body's name.
Positions start_positions(const StartDef& start, const Positions& rest, std::uint64_t seed, const std::string& body);

}  // namespace supple
