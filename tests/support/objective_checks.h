// The objective of a step: against its own differences, and where a step ended against where it began.
#pragma once

#include <string>

#include "sim/model/inputs.h"
#include "sim/model/model.h"
#include "sim/model/state.h"

namespace supple::test {

// At a random deformed state: the gradient is the derivative of the value, and a difference with a reference is the
// difference of the values. name: for messages.
void expect_derivative_of_objective(const BodyDescription& body, const std::string& name);

struct AgainstStaying {
  double staying;  // g(q), the handles at their targets [J]
  double change;   // g(where the step ended) - g(q) [J]
};
AgainstStaying against_staying(const Model& model, const FrameInputs& inputs, const State& before, const State& after);

}  // namespace supple::test
