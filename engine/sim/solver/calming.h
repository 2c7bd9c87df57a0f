// Takes energy out of the movement within a body, and leaves its falling, flying, turning and swinging as a whole
// alone: the part of the velocities that is no rigid motion (rigid_motion.h) dies down. Linear and angular momentum
// stay as they are, and kinetic energy never grows, because the rigid part is a least-squares fit. Not here:
// stiffness-proportional damping, a term of the objective that also slows turning (solver/objective.cpp).
#pragma once

#include "sim/model/model.h"

namespace supple {

// Multiplies by `kept` what the free vertices' velocities have beyond their rigid motion about x.
// x: positions, n x 3, in the model's order [m]; v: velocities, n x 3 [m/s].
void calm(const Model& model, double kept, const Positions& x, Positions& v);

}  // namespace supple
