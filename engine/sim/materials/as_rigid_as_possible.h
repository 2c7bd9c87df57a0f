// Defines the as-rigid-as-possible energy, the material of Projective Dynamics: Psi = mu |F - R|^2 = mu |S - 1|^2. With
// window 0 and full steps the method of this program is then exactly the local/global iteration (Liu et al. 2017,
// section 3).
#pragma once

#include <array>

#include "sim/materials/parameters.h"
#include "sim/materials/small_matrix.h"

namespace supple {

struct AsRigidAsPossible {
  static constexpr std::string_view name = "as-rigid-as-possible";
  static constexpr Needs needs = Needs::stretch;
  double mu = 0;

  static constexpr auto parameters() {
    return std::array{Parameter<AsRigidAsPossible>{"mu", "Pa", "stiffness", &AsRigidAsPossible::mu, Sign::positive}};
  }

  // Returns the energy per rest volume [J/m^3]; `slope` becomes dPsi/dS.
  template <class V>
  V density(const Symmetric3<V>& s, Symmetric3<V>& slope) const {
    const V one(1.0), two_mu(2 * mu);
    const Symmetric3<V> d{s.xx - one, s.yy - one, s.zz - one, s.yz, s.xz, s.xy};
    slope = {two_mu * d.xx, two_mu * d.yy, two_mu * d.zz, two_mu * d.yz, two_mu * d.xz, two_mu * d.xy};
    return V(mu) * squared_norm(d);
  }

  // This is f(s) = a'(s) + 2 b'(s) + c'(s) (equation 10) with a = mu (s-1)^2.
  double axial_stress(double s) const { return 2 * mu * (s - 1); }
};

}  // namespace supple
