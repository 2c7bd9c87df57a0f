// Defines the error of motion of a step, which sees whether bodies turn.
#pragma once

#include "sim/model/model.h"

namespace supple {

// Returns the length of a displacement of the free vertices, sqrt(sum of m |d|^2) [m sqrt(kg)].
double mass_length(const Model& model, const Positions& displacement);

// Returns the error of motion of a step from q to x: how far x is from the solved step x*, over the step's own motion,
// |x - x*|_M / |x* - q|_M. A body that hardly moves has no motion to compare with: it counts as moving by a hundredth
// of what it would do freely, y - q, and by 1e-7 of its size at least. Equation 12 divides by what there is to gain,
// which a stiff body makes so large that it does not see whether the body turns. All n x 3 in the model's order.
double motion_error(const Model& model, const Positions& q, const Positions& y, const Positions& x,
                    const Positions& solved);
// Returns the error of motion where only the distance from the solved step is known [m sqrt(kg)]; x stands for the
// solved step.
double motion_error(const Model& model, const Positions& q, const Positions& y, const Positions& x, double distance);

}  // namespace supple
