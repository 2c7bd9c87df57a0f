// Holds the state of a world after some frames: all that is needed to continue as if it had never stopped.
#pragma once

#include <vector>

#include "scene/replay/live_edits.h"
#include "sim/model/state.h"

namespace supple {

struct WorldState {
  int frames = 0;  // number of finished frames
  std::vector<State> bodies;
  LiveEdits edits = {};  // what was done to the world until then; checkpoints have none
};

}  // namespace supple
