// Keeps the digits of energies near rest. Densities in I_C = tr C, II_C and J = det F have terms of first order in the
// strain that cancel; summed as they stand, they leave a round-off of eps times a modulus, however small the energy is,
// and a line search at rest compares nothing but this round-off. With D = C - 1, det C = J^2 gives the first orders in
// terms of second ones:
//   (I_C - 3)/2 - (J - 1)   = ((J - 1)^2 - II_D - det D) / 2
//   (II_C - 3)/2 - 2 (J - 1) = (J - 1)^2 - II_D/2 - det D
// where II_D is the sum of the principal 2 x 2 minors. Far from rest the right sides cancel in their turn, and the left
// ones are taken.
#pragma once

#include "sim/materials/small_matrix.h"

namespace supple {

template <class V>
struct NearRest {
  V stretching;  // (I_C - 3)/2 - (J - 1)
  V shearing;    // (II_C - 3)/2 - 2 (J - 1)

  // c: F^T F; excess: J - 1.
  NearRest(const Symmetric3<V>& c, const V& excess) {
    const V one(1.0), half(0.5), three(3.0), zero(0.0);
    const Symmetric3<V> d{c.xx - one, c.yy - one, c.zz - one, c.yz, c.xz, c.xy};
    const auto near = squared_norm(d) < V(0.25);
    const Symmetric3<V> minors = cofactor(d);
    const V second = minors.xx + minors.yy + minors.zz, third = determinant(d, minors), excess2 = excess * excess;
    const V first = c.xx + c.yy + c.zz;
    const Symmetric3<V> areas = cofactor(c);
    stretching = choose(near, half * (excess2 - second - third), madd(half, first - three, zero - excess));
    shearing = choose(near, excess2 - madd(half, second, third),
                      madd(half, areas.xx + areas.yy + areas.zz - three, V(-2.0) * excess));
  }
};

}  // namespace supple
