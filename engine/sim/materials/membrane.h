// Defines the closed set of materials of cloth, which have an energy by area in place of one by volume. To add one,
// write a header in this folder, enter it in Membrane, and read it in scene/reading/fabric_reader.cpp, which lists the
// models of cloth by name. Each material has
//   static constexpr std::string_view name
//   static constexpr bool isotropic
//   double compression                                        the share of its stiffness that is left in compression
// An isotropic material also has
//   double mu, lambda                                         its moduli at rest [N/m]
//   static M from(const PlaneLame&, double compression)       as fabric_reader.cpp makes it
//   V density(const V (&s)[2], V (&slope)[2]) const           the energy by the two stretches, s[0] >= s[1], and its
//                                                             derivatives [N/m]
//   double fitted_stiffness(double start, double end) const   k of equation 11 for the tension at the stretches s
//                                                             and 1, over the interval of s [N/m]
// and taut() and natural_width() where density() calls with_tension_field() (tension_field.h). A second woven material
// needs along(), its own overloads of sheet_density() (elements/triangle.h) and sheet_hessian()
// (elements/triangle_stiffness.h), and cases in membrane.cpp, coarse/rest_moduli.cpp and film/record/state_file.cpp,
// which read warp, weft and shear of every material that is not isotropic. film/pictures/drawn_cloth.cpp tells which
// cloth shows yarns. Tests and pages need the material in all_membranes() of tests/support/bodies.cpp, in
// tests/sim/cloth_statics_test.cpp, and in rows of docs/derivatives.md, docs/method.md and docs/scene-format.md. Not
// here: the triangles (elements/triangle.h), and what resists bending, which no triangle does (model/bending.h).
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

// Returns the stiffness with which L is built. For isotropic materials it is k of equation 11 over the stretches from
// start to end, without their weakness under compression; for woven ones it is the stiffness of each thread plus that
// of shear.
MembraneStiffness system_stiffness(const Membrane& membrane, double start, double end);

}  // namespace supple
