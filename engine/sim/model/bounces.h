// Holds the bounces that a body is in the middle of, as a part of its State. Only world/restitution.h reads and writes
// what is in them; everybody else copies them, and files keep their bytes.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/types.h"

namespace supple {

// Describes a bounce off a collider or off another body.
struct Bounce {
  std::int32_t collider = -1, body = -1;  // what the body bounces off: one of the two is -1
  Vec3 normal = Vec3::Zero();             // away from the other side
  Vec3 arm = Vec3::Zero();                // from the center of the body's motion to where it touches [m]
  Vec3 other_arm = Vec3::Zero();          // the same of the other body [m]
  double approach = 0;                    // how fast the two came together [m/s]
  double sunk = 0;                        // how far the two went on together since they touched [m]
  bool is_leaving = false;                // the two no longer come together
  double target = 0;                      // how fast they shall go apart, once they leave [m/s]
  double ahead = 0;                       // speed that elasticity gave while they leave, and that was not due yet [m/s]
  // Until they leave: how much each step took of their approach. From then on: how much the steps to come shall give
  // them, the next one last [m/s].
  std::vector<double> shares = {};
};

struct Bounces {
  std::vector<Bounce> begun;
  double given = 0;  // energy that restitution has given the body since the start [J]
};

// Returns the bounces as bytes, for files that a program of the same version reads on a machine with the same order of
// bytes; none where there never was a bounce.
std::string bytes_of(const Bounces& bounces);

// Returns the bounces that bytes_of() wrote; nothing where the bytes are damaged.
std::optional<Bounces> bounces_from(std::string_view bytes);

}  // namespace supple
