// Defines the parameters of small strains of a thin sheet, whose faces carry no stress (plane stress: Timoshenko and
// Goodier 1951, "Theory of elasticity", section 7).
#pragma once

#include "sim/materials/parameters.h"

namespace supple {

// Holds Lame's parameters of a sheet, times its thickness.
struct PlaneLame {
  double mu, lambda;  // [N/m]

  // Returns the parameters of a sheet: in the place of lambda stands 2 mu lambda / (lambda + 2 mu), which eliminates
  // the strain across the thickness. young [Pa], poisson: below 0.5, thickness [m].
  static PlaneLame from_young(double young, double poisson, double thickness) {
    return {thickness * young / (2 * (1 + poisson)), thickness * young * poisson / (1 - poisson * poisson)};
  }
};

// Returns the stiffness of a plate against bending, E t^3 / (12 (1 - nu^2)) (Timoshenko and Woinowsky-Krieger 1959,
// "Theory of plates and shells", section 1) [N m].
inline double plate_stiffness(double young, double poisson, double thickness) {
  return young * thickness * thickness * thickness / (12 * (1 - poisson * poisson));
}

}  // namespace supple
