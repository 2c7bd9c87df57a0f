// Builds, from the parts of a Method, the solvers with which the paper compares its own. Each of them is a rule for
// search directions.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/model/inputs.h"
#include "sim/model/method.h"
#include "sim/solver/search_rule.h"

namespace supple {

struct Model;

// Says why a method cannot solve a model; nothing where it can.
std::optional<std::string> why_unsuited(const Method& method, const Model& model);

// Returns the rule of a method for a model, with all that does not change from step to step (patterns, rest pose,
// factors). Throws InputError when the parts cannot be combined (problem_of), and when they cannot solve the model.
std::unique_ptr<SearchRule> make_rule(const Method& method, const Model& model);

// Returns the settings with those values that the method fixes whatever a scene says: only L-BFGS has a history, only
// the quasi-Newton method has other matrices, two levels and hard steps that Newton's method finishes, and ADMM and
// vertex blocks have no line search.
SolverSettings settings_of(const Method& method, SolverSettings settings);

// Returns the paper's method and all methods with which the paper compares it.
std::vector<Method> compared_methods();

}  // namespace supple
