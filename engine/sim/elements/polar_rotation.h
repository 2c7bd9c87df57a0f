// Computes the rotation of the polar decomposition F = R S, which the stretch-based materials need, for one matrix in
// each SIMD lane.
#pragma once

#include "sim/elements/svd.h"

namespace supple {

// Returns the rotation R with det R = 1 that maximises tr(R^T F), in a handful of operations. The maximum lambda =
// tr(R^T F) is the largest root of
//   lambda^4 - 2 I lambda^2 - 8 J lambda + I^2 - 4 II = 0,   I = |F|^2, II = |cof F|^2, J = det F,
// and R = d lambda / d F follows by implicit differentiation (Lin, Chitalu, Komura 2022, "Isotropic ARAP energy using
// Cauchy-Green invariants"). The root is found by Halley's method from the upper bound sqrt(3 I): from there the
// iteration falls monotonically. The formula divides by 2 (s1+s2)(s1+s3)(s2+s3). Lanes where that is small, where the
// iteration has not converged, or where something overflowed, take R = U V^T from the singular values, which is
// accurate to a few eps for every F, and is some maximiser where the two smallest stretches cancel. Elsewhere R is
// within about 1e-12 of U V^T in double precision (the root's own conditioning), and near rest within a few eps.
template <class V>
Matrix3<V> polar_rotation(const Matrix3<V>& f) {
  const Matrix3<V> cofactors = cofactor(f);
  const V determ = determinant(f, cofactors);
  const V norm2 = squared_norm(f);
  const V second = squared_norm(cofactors);
  const V two(2.0);
  const V constant = madd(norm2, norm2, V(-4.0) * second), eight_determ = V(8.0) * determ;
  V root = sqrt(V(3.0) * norm2);
  // A step of Halley's method leaves the third power of the error before it, over the squared gap to the other roots.
  // So after a step as small as this, only round-off is left.
  constexpr double small_step = is_single<V> ? 2e-3 : 1e-5;
  constexpr double least_denominator = is_single<V> ? 1e-2 : 1e-3;
  auto moving = root > root;
  for (int step = 0; step < 12; ++step) {
    const V square = root * root;
    const V value = madd(square, square - two * norm2, madd(V(0.0) - eight_determ, root, constant));
    const V slope = madd(root, square - norm2, V(-2.0) * determ);  // a quarter of it
    const V bend = madd(V(3.0), square, V(0.0) - norm2);           // a quarter of it
    const V change = two * value * slope / madd(V(8.0) * slope, slope, V(0.0) - value * bend);
    root = root - change;
    moving = abs(change) > V(small_step) * root;
    if (!some(moving)) break;
  }
  const V square = root * root;
  const V denominator = madd(root, square - norm2, V(-2.0) * determ);
  const auto safe = (denominator > V(least_denominator) * square * root) && !moving;

  const Symmetric3<V> c = symmetric_product(f, f);
  const Matrix3<V> fc = product(f, c);
  const V inverse = V(1.0) / denominator;
  const V weight_f = (square + norm2) * inverse;
  const V weight_cofactor = two * root * inverse;
  const V weight_fc = V(-2.0) * inverse;
  Matrix3<V> r;
  for (int i = 0; i < 9; ++i)
    r.m[i] = madd(weight_f, f.m[i], madd(weight_cofactor, cofactors.m[i], weight_fc * fc.m[i]));
  if (!some(!safe)) return r;
  const V ones[3] = {V(1.0), V(1.0), V(1.0)};
  const Matrix3<V> by_values = recomposed(svd(f), ones);
  for (int i = 0; i < 9; ++i) r.m[i] = choose(safe, r.m[i], by_values.m[i]);
  return r;
}

inline Matrix3<double> polar_rotation(const Matrix3<double>& f) {
  const double ones[3] = {1, 1, 1};
  return recomposed(svd(f), ones);
}

}  // namespace supple
