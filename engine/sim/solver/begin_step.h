// Begins a step: computes y, asks for the wind, moves the handles to their targets, and puts the matrix of the model in
// force.
#pragma once

#include "sim/model/inputs.h"
#include "sim/model/state.h"
#include "sim/solver/open_workspace.h"

namespace supple {

// Computes y = q + h v + f h^2 M^-1 f_ext of every vertex, in the model's order [m], with the factor f of the time
// scheme. Air is not among f_ext: its drag depends on the velocity that the step leads to, and is part of the
// objective.
void inertial_prediction(const Model& model, const StepInputs& inputs, const State& state, Positions& y);

// Begins the forces of air and gas in a step from a state: with the wind at the time at which the integrator evaluates
// forces.
void begin_air(const Model& model, const StepInputs& inputs, const State& state, AirForces& air);

// Writes into the workspace how far the seams are meant to be open at the time at which the integrator evaluates
// forces.
void begin_seams(const Model& model, const StepInputs& inputs, OpenWorkspace& workspace);

// Makes the first part of step(): writes y into the workspace, and sets x of the current iterate to y, but with held
// vertices at their targets.
void begin_step(const Model& model, const StepInputs& inputs, const State& state, OpenWorkspace& workspace);

}  // namespace supple
