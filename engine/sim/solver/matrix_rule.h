// When the matrix that directions start from is renewed: where the elements' stiffness has departed from that where the
// matrix was made by more than a limit; the Hessian, whose renewals are dear, also only now and then. The rule goes by
// the state alone, never by measured time, and State::matrix and its age hold all that it remembers: a step from a copy
// of a state has the same bits, whatever was computed in between, and on any number of threads.
#pragma once

#include "sim/model/inputs.h"
#include "sim/model/state.h"
#include "sim/solver/workspace.h"

namespace supple {

// Has the matrix at hand that the state says, where it says one, so that the next step need not make it.
void prepare_matrix(const Model& model, const SolverSettings& solver, const State& state, Workspace& workspace);

// Sets workspace.system for a step from `state`: A, or a matrix that follows the body. To be called after begin_step().
void choose_matrix(const Model& model, const StepInputs& inputs, const State& state, Workspace& workspace);

// Lets the Hessian serve the step where the settings ask for it, the first iterate touches nothing, and there is one
// that is good enough. To be called when workspace.current is the first iterate.
void choose_hessian(const Model& model, const StepInputs& inputs, const State& state, Workspace& workspace);

// Writes down which matrix the step had.
void remember_matrix(const Model& model, const SolverSettings& solver, const Workspace& workspace, State& state);

}  // namespace supple
