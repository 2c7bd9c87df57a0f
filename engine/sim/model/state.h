// Where a body is: all of it that changes while it moves. Not here: what drives it (inputs.h), what a step tells of
// itself (report.h).
#pragma once

#include <cstdint>
#include <vector>

#include "base/types.h"

namespace supple {

struct Model;

// What handles move their vertices from: rest, or where they grabbed them.
struct Anchors {
  Positions points;           // by Model::handled [m]
  std::vector<Vec3> centers;  // what keys turn about, by handle [m]
  std::vector<char> holds;    // whether each handle holds its vertices; one that has let go pulls at nothing
};

// All that a body's future depends on. A copy is a snapshot.
struct State {
  Positions x;      // positions, n x 3, in the model's order [m]
  Positions v;      // velocities, n x 3 [m/s]
  double time = 0;  // [s]
  Anchors anchors;  // empty where nothing but steps are made, which do not look at them
};

// The model at rest where it was built.
State rest_state(const Model& model);

// XXH64 of all positions, then all velocities, as little-endian doubles in the order of the input file.
std::uint64_t state_hash(const Model& model, const State& state);

// Rows of the input file's order.
Positions in_input_order(const Model& model, const Positions& internal);

}  // namespace supple
