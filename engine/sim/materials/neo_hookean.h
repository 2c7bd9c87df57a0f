// Defines the compressible Neo-Hookean material (Liu et al. 2017, equation 14): Psi = mu/2 (tr F^T F - 3) - mu log J +
// lambda/2 log^2 J, continued below J = 0.1 (log_volume.h).
#pragma once

#include <array>

#include "sim/materials/log_volume.h"
#include "sim/materials/near_rest.h"
#include "sim/materials/parameters.h"

namespace supple {

struct NeoHookean {
  static constexpr std::string_view name = "neo-hookean";
  static constexpr Needs needs = Needs::deformation_gradient;
  double mu = 0;
  double lambda = 0;

  static constexpr auto parameters() {
    return std::array{
        Parameter<NeoHookean>{"mu", "Pa", "shear modulus", &NeoHookean::mu, Sign::positive},
        Parameter<NeoHookean>{"lambda", "Pa", "first Lame parameter", &NeoHookean::lambda, Sign::not_negative}};
  }
  static NeoHookean from(const Lame& lame) { return {lame.mu, lame.lambda}; }

  template <class V>
  V density(const Matrix3<V>& f, Matrix3<V>& stress) const {
    const Matrix3<V> cofactors = cofactor(f);
    const V j = determinant(f, cofactors);
    V slope;
    const V volume = LogVolume{mu, lambda}.beyond_linear(j, slope);
    for (int i = 0; i < 9; ++i) stress.m[i] = madd(V(mu), f.m[i], slope * cofactors.m[i]);
    return madd(V(mu), NearRest<V>(symmetric_product(f, f), j - V(1.0)).stretching, volume);
  }

  // This is equation 10 with a = mu/2 (s^2 - 1), b = 0 and the c of LogVolume; J = s, because the other stretches are
  // 1.
  double axial_stress(double s) const {
    double slope = 0;
    LogVolume{mu, lambda}.beyond_linear(s, slope);
    return mu * s + slope;
  }
  std::vector<double> seams() const { return {LogVolume::smallest_ratio}; }
};

}  // namespace supple
