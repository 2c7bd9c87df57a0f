// Defines the compressible Mooney-Rivlin material: Psi = mu_1/2 (I_C - 3) + mu_2/2 (II_C - 3) - (mu_1 + 2 mu_2) log J +
// lambda/2 log^2 J with C = F^T F, I_C = tr C and II_C = (tr^2 C - tr C^2)/2 = |cof F|^2; continued below J = 0.1
// (log_volume.h).
#pragma once

#include <array>

#include "sim/materials/log_volume.h"
#include "sim/materials/near_rest.h"
#include "sim/materials/parameters.h"

namespace supple {

struct MooneyRivlin {
  static constexpr std::string_view name = "mooney-rivlin";
  static constexpr Needs needs = Needs::deformation_gradient;
  double mu_1 = 0;
  double mu_2 = 0;
  double lambda = 0;

  static constexpr auto parameters() {
    return std::array{
        Parameter<MooneyRivlin>{"mu_1", "Pa", "of squared stretches", &MooneyRivlin::mu_1, Sign::positive},
        Parameter<MooneyRivlin>{"mu_2", "Pa", "of squared areas", &MooneyRivlin::mu_2, Sign::not_negative},
        Parameter<MooneyRivlin>{"lambda", "Pa", "of the squared logarithm of the volume ratio", &MooneyRivlin::lambda,
                                Sign::not_negative}};
  }
  // At small strains the shear modulus is mu_1 + mu_2 and Lame's lambda is lambda + 2 mu_2; a fifth of the shear
  // modulus goes to mu_2, as is usual for rubber.
  static MooneyRivlin from(const Lame& lame) { return {0.8 * lame.mu, 0.2 * lame.mu, lame.lambda - 0.4 * lame.mu}; }
  const char* problem() const {
    return lambda < 0 ? "Poisson's ratio is too small for mooney-rivlin: lambda would be negative (at least 1/7)"
                      : nullptr;
  }

  template <class V>
  V density(const Matrix3<V>& f, Matrix3<V>& stress) const {
    const Matrix3<V> cofactors = cofactor(f);
    const V j = determinant(f, cofactors);
    V slope;
    const V volume = LogVolume{mu_1 + 2 * mu_2, lambda}.beyond_linear(j, slope);
    const Symmetric3<V> c = symmetric_product(f, f);
    const Matrix3<V> fc = product(f, c);
    const V first = c.xx + c.yy + c.zz;
    // d II_C / dF = 2 (tr(C) F - F C)
    const V of_f = madd(V(mu_2), first, V(mu_1));
    for (int i = 0; i < 9; ++i) stress.m[i] = madd(of_f, f.m[i], madd(V(-mu_2), fc.m[i], slope * cofactors.m[i]));
    const NearRest<V> rest(c, j - V(1.0));
    return madd(V(mu_1), rest.stretching, madd(V(mu_2), rest.shearing, volume));
  }

  // This is equation 10 with a = mu_1/2 (s^2 - 1), b = mu_2/2 (s^2 - 1) and c.
  double axial_stress(double s) const {
    double slope = 0;
    LogVolume{mu_1 + 2 * mu_2, lambda}.beyond_linear(s, slope);
    return mu_1 * s + 2 * mu_2 * s + slope;
  }
  std::vector<double> seams() const { return {LogVolume::smallest_ratio}; }
};

}  // namespace supple
