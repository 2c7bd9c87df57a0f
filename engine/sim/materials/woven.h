// This is a woven sheet: warp and weft threads that cross at right angles in the flat pattern, and hardly couple. With
// the columns a and b of F along them,
//   Psi = T_warp(|a|) + T_weft(|b|) + shear/2 (a . b)^2,
//   T(s) = c k/2 (s - 1)^2 + lock k/2 max(0, s - limit)^2, where c is 1 for s >= 1 and `compression` below,
// in the manner of Baraff and Witkin 1998, "Large steps in cloth simulation", section 4. a . b is twice the shear
// strain of Green's tensor, the sine of the angle by which the threads are sheared where they are not stretched. lock
// is 20: a thread whose crimp is pulled out is stiffer by 20 times k.
#pragma once

#include <string_view>

#include "sim/materials/small_matrix.h"

namespace supple {

struct Woven {
  static constexpr std::string_view name = "woven";
  static constexpr bool isotropic = false;
  static constexpr double lock = 20;  // what a thread's stiffness gains beyond its limit, over this stiffness
  double warp = 0, weft = 0;          // [N/m]
  double shear = 0;                   // [N/m]
  double compression = 0.05;          // share of a thread's stiffness that is left below its rest length
  double limit = 1e9;                 // the stretch at which threads lock; 1e9: they do not

  double along(int thread) const { return thread == 0 ? warp : weft; }

  // Holds what a thread does at one stretch: T, T' and T'' [N/m].
  template <class V>
  struct Tension {
    V energy, slope, second;
  };

  template <class V>
  Tension<V> tension(const V& s, double k) const {
    using std::max;
    const V zero(0.0), stiffness(k), locked(lock * k);
    const V strain = s - V(1.0), share = choose(strain < zero, V(compression * k), stiffness);
    const V beyond = max(s - V(limit), zero);
    const V half(0.5);
    return {half * madd(share * strain, strain, locked * beyond * beyond), madd(share, strain, locked * beyond),
            share + choose(beyond > zero, locked, zero)};
  }
};

}  // namespace supple
