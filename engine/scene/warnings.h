// What is legal and unwise in a scene.
#pragma once

#include "scene/assemble.h"

namespace supple {

// k h^2 / (rho L^2), with the stiffness of the body or its fibres: how many times in a step a wave crosses the body,
// squared. Far above 1, ten iterations leave visible error.
double crossing_number(const Body& body);

// In words with a place.
std::vector<Problem> warnings(const SceneDef& scene, const std::vector<Body>& bodies);

}  // namespace supple
