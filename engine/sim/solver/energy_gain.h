// Computes what handles and contacts put into a body, and tells whether a step has gained energy from nothing. An exact
// minimiser of backward Euler's objective cannot where the elastic energy is convex between q and x: M (x - q - h v) /
// h^2 = m g - grad E(x) gives K' - K + E(x) - E(q) - m g . (x - q) <= the work of what is moved from outside. A step
// that was left far from its minimum can, again and again, without bound.
#pragma once

#include "sim/model/state.h"
#include "sim/solver/workspace.h"

namespace supple {

// Returns the work over a step from q to the current iterate that hard handles and contacts do on the body, by the
// forces at its end [J]. Evaluates all elements where a hard handle has moved, and then overwrites the workspace's
// trial energies and forces.
double work_from_outside(const Model& model, const Positions& q, Workspace& workspace);

// Tells whether such a step may have gained more than this share of the energies that it moves, by a bound that
// evaluates nothing. Where E is convex between q and x, the energy from nothing is at most r . (x - q) - 1/2 |v' -
// v|^2_M, where r is what is left of the gradient of g at x: the current iterate's, which must be there.
bool may_gain_energy(const Model& model, const StepInputs& inputs, const State& state, const Workspace& workspace,
                     double share);

// Returns the energy that the step to the current iterate gained from nothing, over the energies that it exchanged: a
// hundredth is much. Zero or less where it gained none, and for integrators other than backward Euler. Evaluates all
// elements at q.
double share_from_nothing(const Model& model, const StepInputs& inputs, const State& state, Workspace& workspace);

}  // namespace supple
