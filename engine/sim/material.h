// The closed set of materials. A new one is a header in materials/ (parameters, energy density with its derivative,
// axial stress) and an entry here; kernels, scene files, the stiffness fit and the derivative tests then know it.
#pragma once

#include <variant>

#include "sim/materials/as_rigid_as_possible.h"
#include "sim/materials/corotated.h"
#include "sim/materials/neo_hookean.h"
#include "sim/materials/polynomial.h"

namespace supple {

using Material = std::variant<AsRigidAsPossible, Polynomial, Corotated, NeoHookean>;

inline std::string_view name_of(const Material& material) {
  return std::visit([](const auto& m) { return m.name; }, material);
}

// The stretch interval of equation 11.
struct StretchInterval {
  double start = 0.5;
  double end = 1.5;
};

// k of equation 11: the slope of the line through rest that fits the axial stress f best over the interval, by
// Gauss-Legendre quadrature. Can be zero or negative for materials that soften; Model puts a floor under it. [Pa]
double stiffness(const Material& material, const StretchInterval& interval = {});

}  // namespace supple
