// Warns about scenes that are legal but unwise.
#pragma once

#include <string>
#include <vector>

#include "scene/assemble.h"

namespace supple {

// Computes k h^2 / (rho L^2), with the stiffness of the body or its fibres: the square of the number of times that a
// wave crosses the body in one step. When it is far above 1, ten iterations leave a visible error.
double crossing_number(const Body& body);

// Each warning points to its place in the scene file.
std::vector<Problem> warnings(const SceneDef& scene, const std::vector<Body>& bodies);

// Advises solver.untangle where it is off and a body starts with elements that are inverted or flat, of a material that
// may stay folded from there (docs/stability.md); empty elsewhere.
std::string untangle_advice(const Body& body);

// Lists what the scene asks its pictures to show and no run can show while it is made: only drawings of a run can.
std::vector<Problem> known_after_film(const SceneDef& scene);

}  // namespace supple
