// Defines the closed set of materials, and k of equation 11, which follows from each. To add one, write a header in
// this folder (name, needs, parameters(), density(), axial_stress(): parameters.h) and enter it here: kernels, scene
// files and the stiffness fit then use it. docs/adding-a-material.md describes the steps, and lists what tests and
// pages need.
#pragma once

#include <variant>

#include "sim/materials/as_rigid_as_possible.h"
#include "sim/materials/corotated.h"
#include "sim/materials/fixed_corotated.h"
#include "sim/materials/mooney_rivlin.h"
#include "sim/materials/neo_hookean.h"
#include "sim/materials/polynomial.h"
#include "sim/materials/spline.h"
#include "sim/materials/st_venant_kirchhoff.h"
#include "sim/materials/stable_neo_hookean.h"
#include "sim/materials/strain_limiting.h"

namespace supple {

using Material = std::variant<AsRigidAsPossible, Polynomial, Corotated, StVenantKirchhoff, NeoHookean, MooneyRivlin,
                              FixedCorotated, StableNeoHookean, Spline, StrainLimiting>;

std::string_view name_of(const Material& material);

// Tells whether some deformation has less energy than rest.
bool energy_may_be_negative(const Material& material);

// Tells whether a material has no stress in an interval around rest, where only inertia holds a body.
bool has_slack(const Material& material);

// Holds the stretch interval of equation 11.
struct StretchInterval {
  double start = 0.5;
  double end = 1.5;
};

// Returns k of equation 11: the slope of the line through rest that fits the axial stress f best over the interval, by
// Gauss-Legendre quadrature [Pa]. It can be zero or negative for materials that soften.
double fitted_stiffness(const Material& material, const StretchInterval& interval = {});

// Holds the k with which M/h^2 + L is built: the fit (or what the material requires instead), but at least the floor. A
// spline that a user draws can soften so much that the fit is negative, and the matrix would not be positive definite.
struct SystemStiffness {
  double k = 0;          // [Pa]
  bool floored = false;  // the fit was below a thousandth of the steepest secant of f
};
SystemStiffness system_stiffness(const Material& material, const StretchInterval& interval = {});

}  // namespace supple
