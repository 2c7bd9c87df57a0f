// The solvers that the paper compares with, built from the parts of a Method: each is a rule for search directions.
#pragma once

#include <memory>
#include <vector>

#include "sim/model/method.h"
#include "sim/solver/lbfgs.h"

namespace supple {

// Prepares all that does not change from step to step (patterns, rest pose, factors). Throws InputError when the parts
// do not go together (problem_of).
std::unique_ptr<SearchRule> make_rule(const Method& method, const Model& model);

// Settings that belong to a method whatever a scene says: only L-BFGS has a history, and Hecht's method has no line
// search.
SolverSettings settings_of(const Method& method, SolverSettings settings);

// The paper's method and all that the paper compares it with.
std::vector<Method> compared_methods();

}  // namespace supple
