// Defines corotated linear elasticity: Psi = mu |F - R|^2 + lambda/2 tr^2(R^T F - 1).
#pragma once

#include <array>

#include "sim/materials/parameters.h"
#include "sim/materials/small_matrix.h"

namespace supple {

struct Corotated {
  static constexpr std::string_view name = "corotated";
  static constexpr Needs needs = Needs::stretch;
  double mu = 0;
  double lambda = 0;

  static constexpr auto parameters() {
    return std::array{
        Parameter<Corotated>{"mu", "Pa", "shear modulus", &Corotated::mu, Sign::positive},
        Parameter<Corotated>{"lambda", "Pa", "first Lame parameter", &Corotated::lambda, Sign::not_negative}};
  }
  static Corotated from(const Lame& lame) { return {lame.mu, lame.lambda}; }

  template <class V>
  V density(const Symmetric3<V>& s, Symmetric3<V>& slope) const {
    const V one(1.0), two_mu(2 * mu);
    const Symmetric3<V> d{s.xx - one, s.yy - one, s.zz - one, s.yz, s.xz, s.xy};
    const V trace = d.xx + d.yy + d.zz;
    const V pressure = V(lambda) * trace;
    slope = {madd(two_mu, d.xx, pressure),
             madd(two_mu, d.yy, pressure),
             madd(two_mu, d.zz, pressure),
             two_mu * d.yz,
             two_mu * d.xz,
             two_mu * d.xy};
    return madd(V(mu), squared_norm(d), V(0.5) * pressure * trace);
  }

  // This is equation 10 with a = mu (s-1)^2 + lambda/2 (s^2 - 6 s + 3), b = lambda s.
  double axial_stress(double s) const { return 2 * mu * (s - 1) + lambda * (s - 3) + 2 * lambda; }
};

}  // namespace supple
