// Where the iterations of a step start: y, or a better point where handles or colliders make y a bad one.
#pragma once

#include "sim/solver/objective.h"

namespace supple {

// y = q + h v + f h^2 M^-1 f_ext of every vertex, in the model's order [m].
void inertial_prediction(const Model& model, const FrameInputs& inputs, const State& state, Positions& y);

// The first part of step(): y, and the targets of handles in y's place, into the workspace. Also leaves x = y.
void begin_step(const Model& model, const FrameInputs& inputs, const State& state, Workspace& workspace);

// Chooses workspace.x and evaluates it there. Returns g(y) - g(x), handles at their targets, where that is known, or 0:
// equation 12 counts from y [J].
double set_first_iterate(const Model& model, const FrameInputs& inputs, const State& state, Workspace& workspace);

// g, its gradient and energies at workspace.x, with the contacts found there, as the report's next objective.
void evaluate_start(const Model& model, const FrameInputs& inputs, Workspace& workspace);

// Contacts at x, their time taken from that of evaluations, whose stopwatch is running.
void find_contacts_timed(const Model& model, const FrameInputs& inputs, const Positions& x, Workspace& workspace);

// workspace.trial = x + alpha d for the free vertices; handled ones stay at their targets.
void set_trial(const Model& model, Workspace& workspace, double alpha);

}  // namespace supple
