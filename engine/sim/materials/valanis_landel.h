// Computes the form that all materials here have, stable Neo-Hookean apart (Valanis and Landel 1967; Liu et al. 2017,
// equation 9): Psi = sum a(s_i) + sum b(s_i s_j) + c(s_1 s_2 s_3). It serves materials that are given by their
// functions, and tests; a closed formula in F or S is cheaper where there is one.
#pragma once

#include "sim/materials/small_matrix.h"

namespace supple {

// Stands for a function that a material does not have.
struct NoTerm {
  static constexpr double slope_at_rest() { return 0; }
};

// Returns the energy density at the stretches s; `slope` becomes dPsi/ds_i. b and c may be NoTerm; any other function
// offers slope_at_rest(), its slope at 1, and beyond_linear(x, slope), which returns its value at x less that at 1 and
// less slope_at_rest() (x - 1), and sets its slope at x. The terms of first order cancel at rest, so they are added as
// what remains of them in e_i = s_i - 1:
//   sum e_i (a' + 2 b' + c') + sum e_i e_j (b' + c') + e_1 e_2 e_3 c'.
template <class V, class A, class B, class C>
V valanis_landel(const A& a, const B& b, const C& c, const V (&s)[3], V (&slope)[3]) {
  V energy(0.0);
  for (int i = 0; i < 3; ++i) energy = energy + a.beyond_linear(s[i], slope[i]);
  const V pair[3] = {s[1] * s[2], s[2] * s[0], s[0] * s[1]};  // without s_i
  if constexpr (!std::is_same_v<B, NoTerm>) {
    V of_pair[3];
    for (int i = 0; i < 3; ++i) energy = energy + b.beyond_linear(pair[i], of_pair[i]);
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      slope[i] = madd(of_pair[j], s[k], madd(of_pair[k], s[j], slope[i]));
    }
  }
  if constexpr (!std::is_same_v<C, NoTerm>) {
    V of_volume;
    energy = energy + c.beyond_linear(s[0] * pair[0], of_volume);
    for (int i = 0; i < 3; ++i) slope[i] = madd(of_volume, pair[i], slope[i]);
  }
  const V e[3] = {s[0] - V(1.0), s[1] - V(1.0), s[2] - V(1.0)};
  const double of_all = c.slope_at_rest(), of_pairs = b.slope_at_rest() + of_all;
  const double of_one = a.slope_at_rest() + b.slope_at_rest() + of_pairs;
  const V pairs = madd(e[0], e[1], madd(e[1], e[2], e[2] * e[0]));
  return madd(V(of_one), e[0] + e[1] + e[2], madd(V(of_pairs), pairs, madd(V(of_all), e[0] * e[1] * e[2], energy)));
}

}  // namespace supple
