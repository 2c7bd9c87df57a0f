// This material is linear near rest and hardens far from it: Psi = mu |S - 1|^2 + nu |(S - 1)^3|^2.
#pragma once

#include <array>

#include "sim/materials/parameters.h"
#include "sim/materials/small_matrix.h"

namespace supple {

struct Hardening {
  static constexpr std::string_view name = "hardening";
  static constexpr Needs needs = Needs::stretch;
  double mu = 0;
  double nu = 0;

  static constexpr auto parameters() {
    return std::array{Parameter<Hardening>{"mu", "Pa", "stiffness near rest", &Hardening::mu, Sign::positive},
                      Parameter<Hardening>{"nu", "Pa", "stiffness far from it", &Hardening::nu, Sign::not_negative}};
  }

  template <class V>
  V density(const Symmetric3<V>& s, Symmetric3<V>& slope) const {
    const V one(1.0), two_mu(2 * mu), six_nu(6 * nu);
    const Symmetric3<V> d{s.xx - one, s.yy - one, s.zz - one, s.yz, s.xz, s.xy};
    const Symmetric3<V> d2 = commuting_product(d, d);
    const Symmetric3<V> d3 = commuting_product(d2, d);
    const Symmetric3<V> d5 = commuting_product(d3, d2);
    slope = {madd(two_mu, d.xx, six_nu * d5.xx), madd(two_mu, d.yy, six_nu * d5.yy),
             madd(two_mu, d.zz, six_nu * d5.zz), madd(two_mu, d.yz, six_nu * d5.yz),
             madd(two_mu, d.xz, six_nu * d5.xz), madd(two_mu, d.xy, six_nu * d5.xy)};
    return madd(V(mu), squared_norm(d), V(nu) * squared_norm(d3));
  }

  // Follows from a = mu (s-1)^2 + nu (s-1)^6.
  double axial_stress(double s) const {
    const double e = s - 1;
    return 2 * mu * e + 6 * nu * e * e * e * e * e;
  }
};

}  // namespace supple
