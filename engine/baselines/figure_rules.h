// Makes rules for search directions that figures of the paper need. Scenes cannot name them, because no body is solved
// better by them. A Method has no parts for them; their settings are given here.
#pragma once

#include <memory>

#include "sim/model/inputs.h"
#include "sim/solver/search_rule.h"

namespace supple {

// Returns a rule that takes directions from a warped Hessian, which is factored anew in every other search and turned
// at each vertex in between (Hecht, Lee, Shewchuk, O'Brien 2012; figure 10). What the rule keeps from step to step is
// not in the State, so that its films cannot be resumed.
std::unique_ptr<SearchRule> make_hecht_rule(const Model& model);

// Returns the settings with which Hecht's method was published: without pairs and without line search.
SolverSettings hecht_settings(SolverSettings settings);

// Returns a rule that takes directions from algorithm 2 of the paper to the letter: L-BFGS from A, by the two-loop
// recursion as it is written. Contacts are in the gradients of the pairs, with the planes of the iteration that made
// them, and nowhere else in the directions (section 4.3). The settings must have levels = 1.
std::unique_ptr<SearchRule> make_paper_rule(const Model& model);

}  // namespace supple
