// Defines the St. Venant-Kirchhoff material: Psi = mu |E|^2 + lambda/2 tr^2 E, E = (F^T F - 1)/2. It softens under
// compression and does not resist inversion: below a stretch of 1/sqrt(3) its resistance decreases. It is included
// because papers compare with it.
#pragma once

#include <array>

#include "sim/materials/parameters.h"
#include "sim/materials/small_matrix.h"

namespace supple {

struct StVenantKirchhoff {
  static constexpr std::string_view name = "st-venant-kirchhoff";
  static constexpr Needs needs = Needs::deformation_gradient;
  double mu = 0;
  double lambda = 0;

  static constexpr auto parameters() {
    return std::array{Parameter<StVenantKirchhoff>{"mu", "Pa", "shear modulus", &StVenantKirchhoff::mu, Sign::positive},
                      Parameter<StVenantKirchhoff>{"lambda", "Pa", "first Lame parameter", &StVenantKirchhoff::lambda,
                                                   Sign::not_negative}};
  }
  static StVenantKirchhoff from(const Lame& lame) { return {lame.mu, lame.lambda}; }

  // P = F (2 mu E + lambda tr(E) 1).
  template <class V>
  V density(const Matrix3<V>& f, Matrix3<V>& stress) const {
    const Symmetric3<V> c = symmetric_product(f, f);
    const V half(0.5), one(1.0), two_mu(2 * mu);
    const Symmetric3<V> e{half * (c.xx - one), half * (c.yy - one), half * (c.zz - one),
                          half * c.yz,         half * c.xz,         half * c.xy};
    const V trace = e.xx + e.yy + e.zz, pressure = V(lambda) * trace;
    stress = product(f, Symmetric3<V>{madd(two_mu, e.xx, pressure), madd(two_mu, e.yy, pressure),
                                      madd(two_mu, e.zz, pressure), two_mu * e.yz, two_mu * e.xz, two_mu * e.xy});
    return madd(V(mu), squared_norm(e), half * pressure * trace);
  }

  // This is equation 10 with a = mu/4 (s^2-1)^2 + lambda/8 (s^4 - 6 s^2 + 3), b = lambda/4 s^2.
  double axial_stress(double s) const { return mu * s * (s * s - 1) + lambda / 2 * (s * s * s - 3 * s) + lambda * s; }
};

}  // namespace supple
