// Keeps a step from ending worse than where the body stays. g(x) <= g(q) bounds the energy of backward Euler
// (docs/method.md), not that of midpoint, where the velocity of a body that stays is reversed. Where the iterations
// ended higher than staying, because a violent step inverted elements, a second search descends from the body that
// stays. In other steps the comparison costs an evaluation, and only when the inertia of the body that stays cannot
// decide it, or when the elastic energy may be negative.
#pragma once

#include "sim/solver/step_context.h"

namespace supple {

// Returns by how much g is lower where the body stays, friction included [J], if staying is better; the trial iterate
// is then the body that stays. Returns nothing if staying is not better, without a line search, and in a step that
// failed. Friction only takes energy, so its potential is left out of the comparison on both sides.
std::optional<double> gain_of_staying(const StepContext& c);

// Makes the second search, from the trial iterate. gain: what gain_of_staying() has returned.
void descend_from_staying(StepContext& c, double gain);

}  // namespace supple
