// Defines the closed set of materials of cloth, which have an energy by area in place of one by volume. To add one,
// write a header in this folder and enter it here. Such a material has a name, parameters() (parameters.h), and
//   static constexpr bool isotropic
//   V density(const V (&s)[2], V (&slope)[2]) const   where it is isotropic: the energy by the two stretches, s[0] >=
//                                                     s[1], and its derivatives [N/m]
//   double fitted_stiffness(double start, double end) const   where it is isotropic: k of equation 11 for the tension
//                                                     at the stretches s and 1, over the interval of s [N/m]
// A woven material has the members of Woven instead. Not here: the triangles (elements/triangle.h), and what resists
// bending, which no triangle does (model/bending.h).
#pragma once

#include <string_view>
#include <variant>

#include "sim/materials/plane_neo_hookean.h"
#include "sim/materials/plane_st_venant_kirchhoff.h"
#include "sim/materials/woven.h"

namespace supple {

using Membrane = std::variant<PlaneNeoHookean, PlaneStVenantKirchhoff, Woven>;

// Describes what a cloth is made of.
struct Fabric {
  Membrane membrane;
  double bending = 0;  // B, the moment by width that a curvature of 1/m needs [N m]
};

std::string_view name_of(const Membrane& membrane);

// Holds what stands in L for a membrane: the stiffness of each of the two directions of the flat pattern [N/m].
struct MembraneStiffness {
  double along[2];
};

// Returns the stiffness with which L is built. Of isotropic materials it is k of equation 11 over the given stretches,
// without what is weak about compression; of woven ones that of each thread, with that of shear.
MembraneStiffness system_stiffness(const Membrane& membrane, double start, double end);

}  // namespace supple
