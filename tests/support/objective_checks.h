// Checks the objective of a step: against its own differences, and at the end of the step against its beginning.
#pragma once

#include <string>

#include "sim/model/inputs.h"
#include "sim/model/model.h"
#include "sim/model/state.h"

namespace supple::test {

// Checks at a random deformed state that the gradient is the derivative of the value, and that a difference from a
// reference is the difference of the values. name: the name that messages give. wind, air: as in StepInputs.
void expect_derivative_of_objective(const BodyDescription& body, const std::string& name, const Wind& wind = {},
                                    const std::vector<PartAir>& air = {});

struct AgainstStaying {
  double staying;  // g(q), with the handles at their targets [J]
  double change;   // g(where the step ended) - g(q) [J]
};
AgainstStaying against_staying(const Model& model, const StepInputs& inputs, const State& before, const State& after);

}  // namespace supple::test
