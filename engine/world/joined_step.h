// Defines what a world tells of the step of a joined model (islands.h).
#pragma once

#include <cstddef>
#include <vector>

namespace supple {

struct Model;
struct StepInputs;

// Names the step of an island that was made last, for those who repeat it. It holds until the next step is made.
struct JoinedStep {
  std::vector<std::size_t> bodies;     // the parts of the model, in their order
  const Model* model = nullptr;        // the joined one; null: no island has made a step
  const StepInputs* inputs = nullptr;  // of the step
};

}  // namespace supple
