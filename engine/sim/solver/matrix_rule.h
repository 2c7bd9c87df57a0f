// When the matrix that directions start from is renewed: where the elements' stiffness has departed from that where the
// matrix was made by more than a limit. The rule goes by the state alone, never by measured time, and State::matrix
// holds all that it remembers: a step from a copy of a state has the same bits, whatever was computed in between, and
// on any number of threads.
#pragma once

#include "sim/model/inputs.h"
#include "sim/model/state.h"
#include "sim/solver/workspace.h"

namespace supple {

// Has the matrix at hand that the state says, where it says one, so that the next step need not make it.
void prepare_matrix(const Model& model, const State& state, Workspace& workspace);

// Sets workspace.system for a step from `state`: A, or a matrix that follows the body. To be called after begin_step().
void choose_matrix(const Model& model, const StepInputs& inputs, const State& state, Workspace& workspace);

// Writes down which matrix the step had.
void remember_matrix(const Model& model, const Workspace& workspace, State& state);

}  // namespace supple
