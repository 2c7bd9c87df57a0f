// Warns about scenes that are legal but unwise.
#pragma once

#include "scene/assemble.h"

namespace supple {

// Computes k h^2 / (rho L^2), with the stiffness of the body or its fibres: the square of the number of times that a
// wave crosses the body in one step. When it is far above 1, ten iterations leave a visible error.
double crossing_number(const Body& body);

// Each warning points to its place in the scene file.
std::vector<Problem> warnings(const SceneDef& scene, const std::vector<Body>& bodies);

}  // namespace supple
