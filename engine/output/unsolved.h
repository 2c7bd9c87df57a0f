// Names the frames of a film whose steps did not come near their solution, by the solver's own estimate, and those
// whose line searches tried many points an iteration. All such words stand here.
#pragma once

#include <string>
#include <vector>

#include "output/profile.h"

namespace supple {

struct UnsolvedStep {
  int frame;
  std::string body;
  double error_estimate;
  double trials;  // of the line search, an iteration
};

// Tells whether a step with these figures is named: an estimate above 0.1, or more than four trials an iteration.
bool is_unsolved(double error_estimate, int iterations, int trials);

// Lists the bodies' frames with an estimate above 0.1 or more than four trials an iteration.
std::vector<UnsolvedStep> unsolved_steps(const std::vector<FrameRow>& rows);

// "3 of 400 frames were not solved: ...", with the worst of each body; empty where there are none.
std::string unsolved_text(const std::vector<FrameRow>& rows);

}  // namespace supple
