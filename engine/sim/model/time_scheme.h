// Defines how a step goes forward in time: the integrators, and the objective that each of them minimises.
#pragma once

#include <array>

#include "base/names.h"

namespace supple {

enum class Integrator { backward_euler, implicit_midpoint };
template <>
struct Names<Integrator> {
  static constexpr std::array table = {Name{Integrator::backward_euler, "backward-euler"},
                                       Name{Integrator::implicit_midpoint, "implicit-midpoint"}};
};

// Holds the coefficients of the objective that a step minimises: w/(2 h^2) |x - y|^2_M + e E(theta x + (1 - theta) q),
// with y = q + h v + f h^2 M^-1 f_ext. Backward Euler is equation 3; implicit midpoint evaluates forces halfway
// (Hairer, Lubich, Wanner 2006, "Geometric numerical integration", section II.1).
struct TimeScheme {
  double inertia, energy, theta, force;  // w, e, theta, f
};
constexpr TimeScheme scheme_of(Integrator integrator) {
  return integrator == Integrator::backward_euler ? TimeScheme{1, 1, 1, 1} : TimeScheme{2, 2, 0.5, 0.5};
}

}  // namespace supple
