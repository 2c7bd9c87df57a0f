// Finds how stiff a solid must be to sag by a given share of its height under its own weight.
#pragma once

#include "geometry/meshes/mesh.h"

namespace supple {

constexpr double standard_gravity = 9.81;  // [m/s^2]

struct Sagging {
  double density;  // [kg/m^3]
  double poisson;  // Poisson's ratio
  double share;    // share of the height by which the place sinks that sinks furthest
  double sole;     // share of the height: what is as low as this is held
};

// Returns Young's modulus of a Neo-Hookean solid, held at the lowest part of its mesh, y up, that sags by about the
// wanted share [Pa]. first_guess: a guess of the modulus; 0: there is none. The modulus is found by steps of the
// solver, which know large deformations, so that thin legs do not buckle.
double young_for_sag(const TetMesh& mesh, const Sagging& sagging, double first_guess = 0);

// Returns the least modulus, from `young` upwards in steps, with which the same solid stands after it has fallen from a
// height, and nowhere bends down far while it lands [Pa]. Tries six moduli; where all are too soft, returns the next
// one. height: height of the fall [m].
double young_for_fall(const TetMesh& mesh, const Sagging& sagging, double young, double height);

// Returns which share of the mesh's height the place sinks that sinks furthest, with this modulus [Pa].
double sag_of(const TetMesh& mesh, const Sagging& sagging, double young);

}  // namespace supple
