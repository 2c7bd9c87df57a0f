// Finds the moduli of linear elasticity that a material has at rest.
#pragma once

#include "base/types.h"
#include "sim/materials/material.h"
#include "sim/materials/membrane.h"
#include "sim/model/model.h"

namespace supple {

struct RestModuli {
  double mu = 0, lambda = 0;  // of mu |e|^2 + lambda/2 tr^2 e [Pa]
};

// Returns the moduli of a material. Both are 0 where it has no stiffness at rest, like the polynomial.
RestModuli rest_moduli(const Material& material);

// Tells whether a material has next to none of its stiffness at rest: a mu of less than a hundredth of k.
bool is_loose_at_rest(const Material& material, const SystemStiffness& stiffness);

// Tells whether a model has such a material in any region.
bool has_loose_material(const Model& model);

// Returns the symmetric matrix that takes the strains of warp and weft and twice their shear strain to the stresses of
// a membrane that is taut [N/m].
Mat3 plane_moduli(const Membrane& membrane);

}  // namespace supple
