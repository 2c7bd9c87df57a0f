// Defines fixed corotated elasticity (Stomakhin et al. 2012, "Energetically consistent invertible elasticity"): Psi =
// mu |F - R|^2 + lambda/2 (J - 1)^2. It is like corotated near rest, with a volume term that resists inversion.
#pragma once

#include <array>

#include "sim/materials/parameters.h"
#include "sim/materials/small_matrix.h"

namespace supple {

struct FixedCorotated {
  static constexpr std::string_view name = "fixed-corotated";
  static constexpr Needs needs = Needs::stretch;
  double mu = 0;
  double lambda = 0;

  static constexpr auto parameters() {
    return std::array{
        Parameter<FixedCorotated>{"mu", "Pa", "shear modulus", &FixedCorotated::mu, Sign::positive},
        Parameter<FixedCorotated>{"lambda", "Pa", "first Lame parameter", &FixedCorotated::lambda, Sign::not_negative}};
  }
  static FixedCorotated from(const Lame& lame) { return {lame.mu, lame.lambda}; }

  // The formulas used are det S = J and d det S / dS = cof S.
  template <class V>
  V density(const Symmetric3<V>& s, Symmetric3<V>& slope) const {
    const V one(1.0), two_mu(2 * mu);
    const Symmetric3<V> d{s.xx - one, s.yy - one, s.zz - one, s.yz, s.xz, s.xy};
    const Symmetric3<V> cofactors = cofactor(s);
    const V excess = determinant(s, cofactors) - one, pressure = V(lambda) * excess;
    slope = {madd(two_mu, d.xx, pressure * cofactors.xx), madd(two_mu, d.yy, pressure * cofactors.yy),
             madd(two_mu, d.zz, pressure * cofactors.zz), madd(two_mu, d.yz, pressure * cofactors.yz),
             madd(two_mu, d.xz, pressure * cofactors.xz), madd(two_mu, d.xy, pressure * cofactors.xy)};
    return madd(V(mu), squared_norm(d), V(0.5) * pressure * excess);
  }

  // This is equation 10 with a = mu (s-1)^2, c = lambda/2 (s-1)^2.
  double axial_stress(double s) const { return (2 * mu + lambda) * (s - 1); }
};

}  // namespace supple
