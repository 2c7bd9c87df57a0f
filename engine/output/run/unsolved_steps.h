// Names the frames of a film whose steps did not come near their solution, by the solver's own estimate, and those
// whose line searches tried many points an iteration. All such words stand here.
#pragma once

#include <string>
#include <vector>

#include "output/run/profile.h"

namespace supple {

struct UnsolvedStep {
  int frame;
  std::string body;
  double error_estimate, motion_estimate;
  double trials;  // of the line search, an iteration
};

// Lists the bodies' frames of which a step is unsolved.
std::vector<UnsolvedStep> unsolved_steps(const std::vector<FrameRow>& rows);

// "3 of 400 frames did not come near their solution: ...", with the worst of each body and whether it is seen; empty
// where there are none.
std::string unsolved_text(const std::vector<FrameRow>& rows);

}  // namespace supple
