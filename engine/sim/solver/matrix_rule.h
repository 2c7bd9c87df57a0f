// Decides when the matrix that directions start from is renewed: when the elements' stiffness has departed by more than
// a limit from their stiffness where the matrix was made. The turned Hessian, which is dear to renew, is renewed more
// rarely. The rule goes by the state alone, never by measured time, and State::memory holds all that it remembers: a
// step from a copy of a state has the same bits, whatever was computed in between, and on any number of threads.
#pragma once

#include "sim/model/inputs.h"
#include "sim/model/state.h"
#include "sim/solver/open_workspace.h"

namespace supple {

// Makes the matrix that the state names, if it names one, so that the next step need not make it.
void prepare_matrix(const Model& model, const SolverSettings& solver, const State& state, OpenWorkspace& workspace);

// Makes `system` the matrix that directions start from, and sets the corrections for contacts that belong to it.
// Nothing else sets either. `system`: the model itself, for A, or a matrix that follows the body.
void put_in_force(const Model& model, const StepInputs& inputs, const System& system, OpenWorkspace& workspace);

// Sets workspace.system for a step from `state`: A, or a matrix that follows the body. To be called after begin_step().
void choose_matrix(const Model& model, const StepInputs& inputs, const State& state, OpenWorkspace& workspace);

// Lets the turned Hessian serve the step where the settings ask for it, the first iterate touches nothing and is near
// nothing, and there is a Hessian that is good enough. To be called when workspace.current is the first iterate.
void choose_turned_hessian(const Model& model, const StepInputs& inputs, const State& state, OpenWorkspace& workspace);

// Notes in the memory which matrix the step had, and how well its directions did.
void remember_matrix(const Model& model, const SolverSettings& solver, const OpenWorkspace& workspace,
                     SolverMemory& memory);

}  // namespace supple
