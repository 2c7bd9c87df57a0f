// Stable Neo-Hookean material (Smith, de Goes, Kim 2018, "Stable Neo-Hookean flesh simulation", without the term that
// regularises the origin): Psi = mu/2 (I_C - 3) - mu (J - 1) + lambda/2 (J - 1)^2. There is no logarithm, so
// nothing has to be continued. Its lambda is Lame's plus mu.
#pragma once

#include <array>

#include "sim/materials/parameters.h"
#include "sim/materials/small_matrix.h"

namespace supple {

struct StableNeoHookean {
  static constexpr std::string_view name = "stable-neo-hookean";
  static constexpr Needs needs = Needs::gradient;
  double mu = 0;
  double lambda = 0;

  static constexpr auto parameters() {
    return std::array{
        Parameter<StableNeoHookean>{"mu", "Pa", "shear modulus", &StableNeoHookean::mu, false},
        Parameter<StableNeoHookean>{"lambda", "Pa", "of the volume ratio: Lame's lambda plus mu; above mu/3",
                                    &StableNeoHookean::lambda, false}};
  }
  static StableNeoHookean from(const Lame& lame) { return {lame.mu, lame.lambda + lame.mu}; }
  bool energy_may_be_negative() const { return lambda < mu; }  // least at F = 0: (lambda - mu)/2
  // Uniform stretching at rest has the curvature 3 lambda - mu.
  const char* problem() const {
    return 3 * lambda <= mu ? "lambda must be above mu/3: below, the rest shape of stable-neo-hookean is not stable"
                            : nullptr;
  }

  template <class V>
  V density(const Matrix3<V>& f, Matrix3<V>& stress) const {
    const Matrix3<V> cofactors = cofactor(f);
    const V excess = determinant(f, cofactors) - V(1.0);
    const V slope = madd(V(lambda), excess, V(-mu));
    for (int i = 0; i < 9; ++i) stress.m[i] = madd(V(mu), f.m[i], slope * cofactors.m[i]);
    return madd(V(0.5 * mu), squared_norm(f) - V(3.0), excess * madd(V(0.5 * lambda), excess, V(-mu)));
  }

  // This is equation 10 with a = mu/2 (s^2 - 1), c = -mu (s-1) + lambda/2 (s-1)^2.
  double axial_stress(double s) const { return (mu + lambda) * (s - 1); }
};

}  // namespace supple
