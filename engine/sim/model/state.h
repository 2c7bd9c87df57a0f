// Holds the state of a body: position, velocity, and all else that goes from one step to the next. Not here: what
// drives the body (inputs.h), what a step reports (report.h).
#pragma once

#include <cstdint>
#include <vector>

#include "base/types.h"
#include "sim/model/bounces.h"
#include "sim/model/flow.h"
#include "sim/model/solver_memory.h"

namespace supple {

struct Model;

// Holds the places from which handles move their vertices: at rest, or where the handles grabbed them.
struct Anchors {
  Positions points;           // by Model::handled [m]
  std::vector<Vec3> centers;  // what keys turn about, by handle [m]
  std::vector<char> holds;    // whether each handle holds its vertices; one that has let go does not pull
};

// Holds all that a body's future depends on, unless its SearchRule remembers earlier steps (solver/step.h). A copy is a
// snapshot. step() changes x, v, time, and the memory; MovingBody (world/) changes the anchors, and replaces the whole
// state when it restores one.
struct State {
  Positions x;          // positions, n x 3, in the model's order [m]
  Positions v;          // velocities, n x 3 [m/s]
  double time = 0;      // [s]
  Anchors anchors;      // may stay empty where only steps are made: they do not read them
  SolverMemory memory;  // what the body's solver remembers of earlier steps; empty: nothing
  Flow flow;            // the shape that the body keeps; let_flow() changes it between steps (flow_step.h)
  Bounces bounces;      // bounces that are not over; World alone (world/) makes bodies bounce
};

// Returns the state of a model that is at rest where it was built.
State rest_state(const Model& model);

// Returns the XXH64 of all positions, then all velocities, as little-endian doubles in the order of the input file. The
// lists of a flow follow where the body has one.
std::uint64_t state_hash(const Model& model, const State& state);

// Returns the rows reordered from the model's order to the input file's. Vertices are renumbered in a Model (model.h);
// the input file's order is that of BodyDescription::mesh.
Positions in_input_order(const Model& model, const Positions& rows);

}  // namespace supple
