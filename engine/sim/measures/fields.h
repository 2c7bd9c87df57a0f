// Computes fields over a body at a pose, which other programs can show: stretches, stress, energy density, contact
// forces. They are evaluated by the materials' own formulas, outside the step. Not here: numbers for a whole body
// (measures.h).
#pragma once

#include <array>
#include <vector>

#include "sim/model/model.h"
#include "sim/model/state.h"

namespace supple {

struct OpenWorkspace;

struct ElementFields {
  // These fields have one entry for each tetrahedron of the input; they are empty when there are none. F is F_e where
  // the body keeps dents (model/flow.h).
  Positions stretch;              // signed singular values of F, the largest first, m x 3
  std::vector<double> von_mises;  // of Cauchy's stress P F^T / det F, fibres included; NaN where det F = 0 [Pa]
  std::vector<double> energy;     // density, over rest volume, fibres included [J/m^3]
  // This field has one entry for each vertex of the input: half of the energy of each spring that ends there. It is
  // empty without springs.
  std::vector<double> spring_energy;  // [J]
  std::vector<double> cloth_energy;   // of triangles, by area at rest, without bending [J/m^2]
};

// Returns von Mises' equivalent of Cauchy's stress P F^T / det F; NaN where det F = 0. piola: P, in the unit of the
// result.
double von_mises(const Mat3& f, const Mat3& piola);

// Computes the fields at a pose. x: positions in the model's order.
ElementFields element_fields(const Model& model, const Positions& x);

// Returns the force of all contacts on each vertex at the end of the workspace's last step, friction included, by
// vertex of the input, n x 3; vertices that hard handles hold have 0 [N]. x: the positions where that step ended, in
// the model's order.
Positions contact_forces(const Model& model, const OpenWorkspace& workspace, const Positions& x);

// Returns the two stretches of each triangle in its plane, the larger one first. rest, x: n x 3 in the order of the
// triangles' indices; a triangle without area at rest gets NaN.
std::vector<std::array<double, 2>> triangle_stretches(const Positions& rest, const Positions& x,
                                                      const Triangles& triangles);

}  // namespace supple
