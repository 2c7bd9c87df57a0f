// Carries curvature from one step to the next: one pair of L-BFGS, the sum of all pairs of the step before, which
// serves the first direction (Morales and Nocedal 2000 begin with pairs of the problem before; "Automatic
// preconditioning by limited memory quasi-Newton updating"). It is what the whole step corrected, and bodies correct
// much the same in the next. Where they do not, the first iteration shows it, and the next steps begin without. A step
// that touches something neither takes a pair nor leaves one; a step that ends unsolved leaves none (docs/method.md, "A
// pair that is carried over", has the numbers). All rules count steps and compare numbers of the state.
#pragma once

#include "sim/solver/lbfgs.h"

namespace supple {

// Begins a step: finds out whether the state has a pair for it.
void choose_carried_pair(const Model& model, const SolverSettings& solver, const State& state, Workspace& w);

// Ends the step, whose error is estimated in the report: the state gets the sum of the pairs of its first search, if
// that was the only one.
void remember_carried_pair(Workspace& w, State& state);

}  // namespace supple
