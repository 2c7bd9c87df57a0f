// The form of all isotropic materials here (Valanis and Landel 1967; Liu et al. 2017, equation 9): Psi = sum a(s_i) +
// sum b(s_i s_j) + c(s_1 s_2 s_3). It serves materials that are given by their functions, and tests; a closed
// formula in F or S is cheaper where there is one.
#pragma once

#include "sim/materials/small_matrix.h"

namespace supple {

// This stands for a function that a material does not have.
struct NoTerm {};

// a, b and c each offer value(x, slope), as LogVolume does, or are NoTerm. `slope` becomes dPsi/ds_i.
template <class V, class A, class B, class C>
V valanis_landel(const A& a, const B& b, const C& c, const V (&s)[3], V (&slope)[3]) {
  V energy(0.0);
  for (int i = 0; i < 3; ++i) energy = energy + a.value(s[i], slope[i]);
  const V pair[3] = {s[1] * s[2], s[2] * s[0], s[0] * s[1]};  // without s_i
  if constexpr (!std::is_same_v<B, NoTerm>) {
    V of_pair[3];
    for (int i = 0; i < 3; ++i) energy = energy + b.value(pair[i], of_pair[i]);
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      slope[i] = madd(of_pair[j], s[k], madd(of_pair[k], s[j], slope[i]));
    }
  }
  if constexpr (!std::is_same_v<C, NoTerm>) {
    V of_volume;
    energy = energy + c.value(s[0] * pair[0], of_volume);
    for (int i = 0; i < 3; ++i) slope[i] = madd(of_volume, pair[i], slope[i]);
  }
  return energy;
}

}  // namespace supple
