// Defines the paper's polynomial material: Psi = mu sum (s_i - 1)^4 = mu tr (S - 1)^4. It resists small strains weakly
// and large ones strongly, so it jiggles and keeps its shape (Liu et al. 2017, section 4.1 and figure 2).
#pragma once

#include <array>

#include "sim/materials/parameters.h"
#include "sim/materials/small_matrix.h"

namespace supple {

struct Polynomial {
  static constexpr std::string_view name = "polynomial";
  static constexpr Needs needs = Needs::stretch;
  double mu = 0;

  static constexpr auto parameters() {
    return std::array{Parameter<Polynomial>{"mu", "Pa", "stiffness", &Polynomial::mu, Sign::positive}};
  }

  // With tr D^4 = |D^2|^2 for the symmetric D = S - 1, and d tr D^4 / dS = 4 D^3, no eigenvalues are needed.
  template <class V>
  V density(const Symmetric3<V>& s, Symmetric3<V>& slope) const {
    const V one(1.0), four_mu(4 * mu);
    const Symmetric3<V> d{s.xx - one, s.yy - one, s.zz - one, s.yz, s.xz, s.xy};
    const Symmetric3<V> d2 = commuting_product(d, d);
    const Symmetric3<V> d3 = commuting_product(d2, d);
    slope = {four_mu * d3.xx, four_mu * d3.yy, four_mu * d3.zz, four_mu * d3.yz, four_mu * d3.xz, four_mu * d3.xy};
    return V(mu) * squared_norm(d2);
  }

  // This is equation 10 with a = mu (s-1)^4.
  double axial_stress(double s) const { return 4 * mu * (s - 1) * (s - 1) * (s - 1); }
};

}  // namespace supple
