// Defines two strain-limiting constraints of Projective Dynamics (Bouaziz et al. 2014, section 5.1): each pulls F to
// the nearest matrix whose stretches lie in an interval, Psi = sum_i mu_i |F - clamp_i(F)|^2, that is a = sum_i mu_i (s
// - clamp_i(s))^2 in the stretches. There is no energy between the limits. Two such constraints are the paper's
// piecewise linear substitute for the polynomial material (figure 11). The prefactored matrix of Projective Dynamics
// gives a constraint its full weight even while it is inactive: system_stiffness() does the same, and the damping in
// figure 11 comes from that.
#pragma once

#include <array>

#include "sim/materials/parameters.h"
#include "sim/materials/small_matrix.h"

namespace supple {

struct StrainLimiting {
  static constexpr std::string_view name = "strain-limiting";
  static constexpr Needs needs = Needs::singular_values;
  double mu_1 = 0, low_1 = 0, high_1 = 0;
  double mu_2 = 0, low_2 = 1, high_2 = 1;

  static constexpr auto parameters() {
    using S = StrainLimiting;
    return std::array{Parameter<S>{"mu_1", "Pa", "stiffness of the first constraint", &S::mu_1, Sign::positive},
                      Parameter<S>{"low_1", "", "stretch below which it acts", &S::low_1, Sign::not_negative},
                      Parameter<S>{"high_1", "", "stretch above which it acts", &S::high_1, Sign::positive},
                      Parameter<S>{"mu_2", "Pa", "stiffness of the second constraint", &S::mu_2, Sign::not_negative},
                      Parameter<S>{"low_2", "", "stretch below which it acts", &S::low_2, Sign::not_negative, 1.0},
                      Parameter<S>{"high_2", "", "stretch above which it acts", &S::high_2, Sign::positive, 1.0}};
  }
  const char* problem() const {
    return low_1 > 1 || low_2 > 1 || high_1 < 1 || high_2 < 1 ? "limits must enclose 1: low at most 1, high at least 1"
                                                              : nullptr;
  }

  template <class V>
  V density(const V (&s)[3], V (&slope)[3]) const {
    using std::max;
    using std::min;
    V energy(0.0);
    for (int i = 0; i < 3; ++i) {
      const V first = s[i] - min(max(s[i], V(low_1)), V(high_1)), second = s[i] - min(max(s[i], V(low_2)), V(high_2));
      slope[i] = madd(V(2 * mu_1), first, V(2 * mu_2) * second);
      energy = madd(V(mu_1) * first, first, madd(V(mu_2) * second, second, energy));
    }
    return energy;
  }

  double axial_stress(double s) const {
    return 2 * mu_1 * (s - std::min(std::max(s, low_1), high_1)) +
           2 * mu_2 * (s - std::min(std::max(s, low_2), high_2));
  }
  std::vector<double> seams() const { return {low_1, high_1, low_2, high_2}; }
  double system_stiffness() const { return 2 * (mu_1 + mu_2); }
};

}  // namespace supple
