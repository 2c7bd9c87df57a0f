// Defines where a body starts: at rest, or deformed on purpose, to show how it recovers. Not here: motion from outside
// (handles), and the form of start states in scene files (start_reader.cpp). A new start state is a struct with
// place(), an entry in StartDef, and a reader.
#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <variant>

#include "base/types.h"

namespace supple {

// Describes the body at rest, at its place in the world, to which start states are relative.
struct RestFrame {
  Bounds box;
  Vec3 center = Vec3(0, 0, 0);  // of the box [m]
};

// Generates uniformly distributed random numbers that are the same on every machine and with every library.
class UniformNumbers {
 public:
  explicit UniformNumbers(std::uint64_t seed) : engine_(seed) {}
  double between(double low, double high) {
    return low + (high - low) * 0x1p-53 * static_cast<double>(engine_() >> 11);
  }

 private:
  std::mt19937_64 engine_;
};

struct AtRest {
  Vec3 place(const Vec3& rest, const RestFrame&, UniformNumbers&) const { return rest; }
};

struct Stretched {
  Vec3 factors;
  Vec3 place(const Vec3& rest, const RestFrame& frame, UniformNumbers&) const;
};

struct Rotated {
  Mat3 rotation;
  Vec3 place(const Vec3& rest, const RestFrame& frame, UniformNumbers&) const;
};

// Twists the body about the longest axis of its box, by this angle from one end to the other.
struct Twisted {
  double degrees;
  Vec3 place(const Vec3& rest, const RestFrame& frame, UniformNumbers&) const;
};

// Places every vertex at a random position in a box around the centre.
struct Random {
  Vec3 extent;  // [m]
  Vec3 place(const Vec3& rest, const RestFrame& frame, UniformNumbers& numbers) const;
};

// Flattens the body onto a level plane, a line along x, or a point.
struct Flattened {
  Vec3 kept;  // 1 for the coordinates that stay
  Vec3 place(const Vec3& rest, const RestFrame& frame, UniformNumbers&) const;
};

using StartDef = std::variant<AtRest, Stretched, Rotated, Twisted, Random, Flattened>;

// Returns the positions at which all points of a body start. The random numbers depend on the scene's seed and the
// body's name.
Positions start_positions(const StartDef& start, const Positions& rest, std::uint64_t seed, const std::string& body);

}  // namespace supple
