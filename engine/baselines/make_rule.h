// The solvers that the paper compares with, as rules for directions: one each.
#pragma once

#include <memory>

#include "sim/solver/lbfgs.h"
#include "sim/model/method.h"

namespace supple {

// What some rules want to know.
struct RuleSettings {
  double chebyshev_radius = 0.99;  // rho, from training
  int chebyshev_delay = 10;        // S: no acceleration in the first S iterations
};

// Prepares all that does not change from step to step (patterns, rest pose, factors).
std::unique_ptr<SearchRule> make_rule(Method method, const Model& model, const RuleSettings& settings = {});

// Settings that belong to a method whatever a scene says: no history for Newton's kin, no line search for Hecht's.
SolverSettings settings_of(Method method, SolverSettings settings);

}  // namespace supple
