// Lets bodies flow between their steps, and gives what has flowed to their models. A step finds positions with the flow
// that its model has; then the stress that it left flows away as far as the rules say, at these positions. So no flow
// moves a vertex, and momentum stays as it is.
#pragma once

#include "base/threads.h"
#include "sim/model/model.h"
#include "sim/model/state.h"

namespace supple {

// Returns the flow of a body that is at rest where it was built; empty where its model does not flow.
Flow rest_flow(const Model& model);

// Gives what has flowed in a state to a body's model, whose elements then are strained by F_e. Must be called before a
// model is used for a state other than the one it was last used for. Does nothing where the model does not flow.
void show_flow(const Flow& flow, Model& model);

// Does the same for a model into which bodies are joined; the bodies' own models must have their flow already.
void show_flow(const std::vector<const Model*>& bodies, Model& joined);

// Lets a body flow for the time since it last did, and gives the result to its model, which must have the state's flow.
// Does nothing where no time has gone by. lost: scratch that keeps its memory.
void let_flow(Model& model, State& state, Threads* threads, std::vector<double>& lost);

}  // namespace supple
