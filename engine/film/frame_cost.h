// Measures what the frames of a scene cost on this machine: the first ones are simulated, and nothing is recorded.
#pragma once

#include <string>
#include <vector>

#include "world/world.h"

namespace supple {

// Holds the cost of one body.
struct FrameCost {
  std::vector<double> frame_ms;  // time of the steps of each frame that was finished
  bool touched = false;          // the body touched a collider, another body or itself at the end of some step
  std::string failure;           // why a step failed; empty: none did
};

// Plays the first `frames` frames of a world that was started. Returns the cost of each body.
std::vector<FrameCost> cost_of_frames(World& world, int frames);

}  // namespace supple
