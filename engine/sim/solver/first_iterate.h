// Chooses where the iterations of a step start: y, or a better point where handles or colliders make y a bad one.
#pragma once

#include "sim/model/inputs.h"
#include "sim/model/state.h"
#include "sim/solver/objective.h"

namespace supple {

// Computes y = q + h v + f h^2 M^-1 f_ext of every vertex, in the model's order [m].
void inertial_prediction(const Model& model, const StepInputs& inputs, const State& state, Positions& y);

// Makes the first part of step(): writes y, and the targets of handles in place of their y, into the workspace. Also
// leaves the current iterate's x = y.
void begin_step(const Model& model, const StepInputs& inputs, const State& state, Workspace& workspace);

// Chooses workspace.current and evaluates it. Returns g(y) - g(x), with handles at their targets, where that is known,
// and 0 elsewhere: equation 12 counts from y [J].
double set_first_iterate(const Model& model, const StepInputs& inputs, const State& state, Workspace& workspace);

// Evaluates workspace.current with the contacts found there, and appends the value to the report's objectives.
void evaluate_start(const Model& model, const StepInputs& inputs, Workspace& workspace);

// Finds the contacts of an iterate; does nothing without colliders.
void find_contacts_of(const Model& model, const StepInputs& inputs, Workspace& workspace, Iterate& iterate);

// Moves the free vertices by a rigid motion.
void move_rigidly(const Model& model, const Eigen::Isometry3d& motion, Positions& x);

// Sets workspace.trial.x = x + alpha d for the free vertices; handled ones stay at their targets.
void set_trial(const Model& model, Workspace& workspace, double alpha);

}  // namespace supple
