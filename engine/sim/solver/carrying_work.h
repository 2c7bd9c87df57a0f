// Holds what a step knows of the pair that it began with and of the one that it leaves (carried_pair.h).
#pragma once

#include <cstdint>

#include "base/types.h"
#include "sim/model/state.h"

namespace supple {

struct CarryingWork {
  bool wanted = false;                // SolverSettings::carry, in a step that keeps pairs
  const CarriedPair* from = nullptr;  // the state's, for the search that begins the step; null: none is to be used
  bool used = false, misled = false;  // by the step in hand
  Positions step, gradient;           // sums over the iterations of the step's first search, n_free x 3 [m], [N]
  int searches = 0;                   // so far; the pair has to do with the first alone, and only where it starts at y
  bool touches = false;               // some iterate of the first search touches something

  std::uint64_t system = 0;      // hash of the model's A
  std::uint64_t system_for = 0;  // Model::id for which that was computed
};

}  // namespace supple
