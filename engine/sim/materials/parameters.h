// Defines what a material of solids says of itself: a name, needs, parameters(), density() and axial_stress(s). The
// last is f = a' + 2 b' + c' of equation 10: the stress along the axis of a sample at F = diag(s, 1, 1), whose sides
// are held. Because a material declares these itself, scene files, stiffness fits and kernels use a new one without
// further changes. For tests and pages, docs/adding-a-material.md lists the places that must name it. Every material is
// isotropic: what has a direction is a Fibre (fibre.h), which scenes add to any material. Not here: the materials of
// cloth (membrane.h).
//
// A material may also have these members, each of which is used where it exists:
//   static M from(const Lame&)          from Young's modulus and Poisson's ratio
//   const char* problem() const         what is wrong with parameters that are each in range, or null
//   std::vector<double> seams() const   stretches where the axial stress changes its formula
//   double system_stiffness() const     k in M/h^2 + L, in place of equation 11
//   bool energy_may_be_negative() const  whether some deformation has less energy than rest; without it, none has
// Spline alone has curves(), functions given by control points, in place of numbers: scene/reading/material_reader.cpp
// reads them into a Spline and into nothing else.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

namespace supple {

// Tells what a formula needs of F: a decomposition that the formula does not use is not computed. density() is a
// template over its number type: SIMD registers, doubles, and Dual of either (elements/dual.h), which has only the
// operations that docs/adding-a-material.md lists.
enum class Needs {
  deformation_gradient,  // F alone: density(F, P)
  stretch,               // S of the polar decomposition F = R S: density(S, dPsi/dS), and P = R dPsi/dS
  singular_values,       // s of F = U diag(s) V^T: density(s, dPsi/ds), and P = U diag(dPsi/ds) V^T
};

// Tells which values a parameter may have. A parameter that may be 0 is 0 where the file does not give it.
enum class Sign { positive, not_negative, any };

// Describes one number of a material as a scene file gives it.
template <class M>
struct Parameter {
  const char* name;
  const char* unit;
  const char* meaning;
  double M::*value;
  Sign sign;
  std::optional<double> fallback = std::nullopt;  // the value when the file gives none
};

// Holds Lame's parameters of small strains.
struct Lame {
  double mu, lambda;  // [Pa]
  // Computes Lame's parameters from Young's modulus [Pa] and Poisson's ratio (below 0.5).
  static Lame from_young(double young, double poisson) {
    return {young / (2 * (1 + poisson)), young * poisson / ((1 + poisson) * (1 - 2 * poisson))};
  }
};

}  // namespace supple
