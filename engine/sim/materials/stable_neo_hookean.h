// This is the stable Neo-Hookean material (Smith, de Goes, Kim 2018, "Stable Neo-Hookean flesh simulation", equation
// 14):
//   Psi = mu/2 (I_C - 3) + lambda/2 (J - alpha)^2 - mu/2 log(I_C + 1),   alpha = 1 + 3 mu / (4 lambda),
// less its value at rest. The last term keeps elements from collapsing to a point: without it F = 0 is a local minimum.
// It is defined for every F, so nothing has to be continued.
#pragma once

#include <array>

#include "sim/materials/near_rest.h"
#include "sim/materials/parameters.h"

namespace supple {

struct StableNeoHookean {
  static constexpr std::string_view name = "stable-neo-hookean";
  static constexpr Needs needs = Needs::deformation_gradient;
  double mu = 0;
  double lambda = 0;

  static constexpr auto parameters() {
    return std::array{
        Parameter<StableNeoHookean>{"mu", "Pa", "4/3 of the shear modulus", &StableNeoHookean::mu, Sign::positive},
        Parameter<StableNeoHookean>{"lambda", "Pa", "of the volume ratio: Lame's lambda plus 5/8 mu; above mu/8",
                                    &StableNeoHookean::lambda, Sign::positive}};
  }
  // Follows equation 16 of the same paper, which makes small strains those of Hooke's law.
  static StableNeoHookean from(const Lame& lame) { return {4.0 / 3 * lame.mu, lame.lambda + 5.0 / 6 * lame.mu}; }
  // For a given J, uniform stretching has the least energy. Along it the slope is zero at rest alone where lambda is
  // above the largest value of 3 (3 s - 1) / (4 (3 s^2 + 1) (1 + s + s^2)) times mu, which is 0.1526.
  bool energy_may_be_negative() const { return lambda < 0.153 * mu; }
  // Uniform stretching at rest has the curvature 9 lambda - 9/8 mu.
  const char* problem() const {
    return 8 * lambda <= mu ? "lambda must be above mu/8: below, the rest shape of stable-neo-hookean is not stable"
                            : nullptr;
  }

  template <class V>
  V density(const Matrix3<V>& f, Matrix3<V>& stress) const {
    using std::log;
    const Matrix3<V> cofactors = cofactor(f);
    const V excess = determinant(f, cofactors) - V(1.0);
    const Symmetric3<V> c = symmetric_product(f, f);
    const V barrier = V(0.25) * (c.xx + c.yy + c.zz + V(1.0));  // (I_C + 1)/4, 1 at rest
    const V of_f = V(mu) - V(0.25 * mu) / barrier, of_volume = madd(V(lambda), excess, V(-0.75 * mu));
    for (int i = 0; i < 9; ++i) stress.m[i] = madd(of_f, f.m[i], of_volume * cofactors.m[i]);
    // The terms of first order: mu/2 (I_C - 3) - mu/8 (I_C - 3) - 3/4 mu (J - 1) cancel in `stretching`.
    return madd(V(0.75 * mu), NearRest<V>(c, excess).stretching,
                madd(V(0.5 * mu), barrier - V(1.0) - log(barrier), V(0.5 * lambda) * excess * excess));
  }

  // The logarithm is no sum over stretches, as equation 10 has it: this is dPsi/ds for F = diag(s, 1, 1).
  double axial_stress(double s) const { return mu * s * (1 - 1 / (s * s + 3)) - 0.75 * mu + lambda * (s - 1); }
};

}  // namespace supple
