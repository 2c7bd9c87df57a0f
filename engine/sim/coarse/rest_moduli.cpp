#include "sim/coarse/rest_moduli.h"

#include <algorithm>

#include "sim/elements/tetrahedron_stiffness.h"

namespace supple {

// In stretches, mu |e|^2 + lambda/2 tr^2 e has the second derivatives 2 mu + lambda and, between two axes, lambda.
RestModuli rest_moduli(const Material& material) {
  return std::visit(
      [](const auto& m) {
        const double rest[3] = {1, 1, 1};
        const StretchDerivatives<double> at = stretch_derivatives(m, rest);
        const double lambda = at.second[0][1];
        return RestModuli{std::max(0.0, (at.second[0][0] - lambda) / 2), std::max(0.0, lambda)};
      },
      material);
}

bool is_loose_at_rest(const Material& material, const SystemStiffness& stiffness) {
  constexpr double loose = 0.01;
  return rest_moduli(material).mu < loose * stiffness.k;
}

bool has_loose_material(const Model& model) {
  for (std::size_t r = 0; r < model.materials.size(); ++r) {
    if (is_loose_at_rest(model.materials[r], model.stiffness[r])) return true;
  }
  return false;
}

Mat3 plane_moduli(const Membrane& membrane) {
  return std::visit(
      [](const auto& sheet) {
        Mat3 moduli = Mat3::Zero();
        if constexpr (std::decay_t<decltype(sheet)>::isotropic) {
          moduli.diagonal() << 2 * sheet.mu + sheet.lambda, 2 * sheet.mu + sheet.lambda, sheet.mu;
          moduli(0, 1) = moduli(1, 0) = sheet.lambda;
        } else {
          moduli.diagonal() << sheet.warp, sheet.weft, sheet.shear;
        }
        return moduli;
      },
      membrane);
}

}  // namespace supple
