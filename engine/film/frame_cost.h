// Measures what a frame of a body costs on this machine: its first frames are simulated, and nothing is recorded.
#pragma once

#include <string>
#include <vector>

#include "scene/driven_body.h"

namespace supple {

struct FrameCost {
  std::vector<double> frame_ms;  // of the steps of each frame that was whole
  State state;                   // after them
  bool touched = false;          // a collider, at the end of any step
  std::string failure;           // why a step failed; empty: none did
};

// Makes the first `frames` frames of a body. The model keeps the values that it has after them (DrivenBody).
FrameCost cost_of_frames(const SceneDef& scene, Body& body, Model& model, const CollisionSet& set,
                         const Solvers& solvers, Threads& threads, int frames);

}  // namespace supple
