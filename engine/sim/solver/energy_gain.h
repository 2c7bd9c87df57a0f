// Computes what handles, contacts and air put into a body, and tells whether a step has gained energy from nothing. An
// exact minimiser of backward Euler's objective cannot gain energy where the elastic energy is convex between q and x:
// M (x - q - h v) / h^2 = m g - grad E(x) gives K' - K + E(x) - E(q) - m g . (x - q) <= the work of what is moved from
// outside. Steps that were left far from their minimum can gain energy again and again, without bound.
#pragma once

#include "sim/solver/step_context.h"

namespace supple {

// Returns the work that hard handles put into the body in a step from q to the current iterate [J]: that of moving held
// vertices against the forces at the step's end, which are those of elements, bending and seams. Where a held vertex
// has moved, evaluates the chunks of elements that have held vertices, and overwrites energies of the trial iterate and
// the workspace's forces.
double work_of_handles(const Model& model, const Positions& q, OpenWorkspace& workspace);

// Returns the work over a step from q to the current iterate that hard handles, contacts and air do on the body, by the
// forces at its end and the ways of the vertices: what backward Euler takes for that work [J]. Evaluates elements as
// work_of_handles() does.
double work_from_outside(const Model& model, const Positions& q, OpenWorkspace& workspace);

// Tells whether the step, left at the current iterate, would gain too much energy from nothing: more than a hundredth
// of the energies that it exchanges and of that of a fall of two steps. The test costs an evaluation at q, so it
// examines only steps whose iterations had a hard time, or whose gradient leaves such a gain possible while there was
// still much to gain.
bool gains_energy(const StepContext& c);

}  // namespace supple
