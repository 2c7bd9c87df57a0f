// Warns of settings of solvers that do less, or more, than they seem to: damping that keeps a body from turning, and a
// matrix that serves no body of the scene. The functions of warnings.h call these.
#pragma once

#include <string>
#include <vector>

#include "scene/building/assemble.h"

namespace supple {

struct SceneDef;

// Computes how fast stiffness-proportional damping takes the spin from a body that nothing holds [1/s]. A turn by a
// small angle a moves each element as if it were strained by sqrt(2) a. So a body of volume V has beta k V a^2 / h in
// the damping's part of g (docs/method.md), beside I a^2 / (2 h^2) in the part of inertia: the rate is 2 beta k V / I,
// whatever h is. I is the mean of the moments of inertia of the rest shape's box about its three axes.
double loss_of_spin(const Body& body);

// Returns a warning of damping that takes half of a free body's spin before the film is over; empty without one. Cloth
// is left out, because it hardly turns as a whole.
std::string damping_text(const SceneDef& scene, const Body& body);

// Returns a warning of a `solver.matrix` that is given and serves none of the bodies; empty without one.
std::string idle_matrix_text(const std::vector<Body>& bodies);

}  // namespace supple
