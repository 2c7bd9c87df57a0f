// The objective of a step against its own differences.
#pragma once

#include <string>

#include "sim/model.h"

namespace supple::test {

// At a random deformed state: the gradient is the derivative of the value, and a difference with a reference is the
// difference of the values. name: for messages.
void expect_derivative_of_objective(const BodyDescription& body, const std::string& name);

}  // namespace supple::test
