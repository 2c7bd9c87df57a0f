// Computes what moving one corner of a tetrahedron, spring or triangle changes: the force there, and the 3 x 3 block of
// second derivatives. In the basis of the singular vectors of F = U S V^T (elements/tetrahedron_stiffness.h) with w =
// V^T grad N of the corner, the force is U (slope o w), and the block is U K U^T with K_pp = h_pp w_p^2 + sum_q (flip +
// twist)/2 w_q^2 and K_pq = (h_pq + (flip - twist)/2) w_p w_q.
#pragma once

#include "sim/elements/spring.h"
#include "sim/elements/tetrahedron_scalar_stiffness.h"
#include "sim/elements/triangle_stiffness.h"

namespace supple {

// Holds dE/dx of a corner [N] and, packed, d^2E/dx^2 [N/m].
template <class V>
struct CornerDerivatives {
  V force[3];
  V block[6];
};

// Adds the fibres' part. With n = F d, l = |n| and c = grad N . d, the force gets c V kappa (1 - 1/l) n, and the block
// gets c^2 V kappa ((1 - 1/l) (1 - n n^T / l^2) + n n^T / l^2). In the block alone, 1 - 1/l counts as zero where it is
// negative.
template <class V>
void add_fibre_corner(const Fibre& fibre, const Matrix3<V>& f, const V (&gradient)[3], const V& volume,
                      CornerDerivatives<V>& sums) {
  using std::max;
  using std::sqrt;
  const V one(1.0), zero(0.0), kappa = V(fibre.kappa) * volume;
  const V d[3] = {V(fibre.direction[0]), V(fibre.direction[1]), V(fibre.direction[2])};
  V n[3];
  for (int i = 0; i < 3; ++i) n[i] = madd(f(i, 0), d[0], madd(f(i, 1), d[1], f(i, 2) * d[2]));
  const V c = madd(gradient[0], d[0], madd(gradient[1], d[1], gradient[2] * d[2]));
  const V length = max(sqrt(madd(n[0], n[0], madd(n[1], n[1], n[2] * n[2]))), V(1e-8));
  const V across = one - one / length, kept = max(across, zero);
  for (int i = 0, at = 0; i < 3; ++i) {
    sums.force[i] = madd(kappa * c * across, n[i], sums.force[i]);
    for (int j = 0; j <= i; ++j, ++at) {
      const V nn = n[i] * n[j] / (length * length);
      sums.block[at] = madd(kappa * c * c, madd(one - kept, nn, i == j ? kept : zero), sums.block[at]);
    }
  }
}

// Differentiates a formula in F along the three coordinates of the corner. The block is the Hessian's, not projected.
template <class M, class V>
CornerDerivatives<V> corner_by_duals(const M& material, const Matrix3<V>& f, const V (&gradient)[3], const V& volume) {
  Matrix3<Dual<V>> at, stress;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      at(i, j).value = f(i, j);
      at(i, j).d[i] = gradient[j];
    }
  }
  material.density(at, stress);
  CornerDerivatives<V> result;
  for (int i = 0, to = 0; i < 3; ++i) {
    result.force[i] = volume * madd(stress(i, 0).value, gradient[0],
                                    madd(stress(i, 1).value, gradient[1], stress(i, 2).value * gradient[2]));
    for (int j = 0; j <= i; ++j, ++to)
      result.block[to] = volume * madd(stress(i, 0).d[j], gradient[0],
                                       madd(stress(i, 1).d[j], gradient[1], stress(i, 2).d[j] * gradient[2]));
  }
  return result;
}

// Finds the derivatives at corner 1 by the singular values. The block belongs to the element's nearest positive
// semi-definite Hessian.
template <class M, class V>
CornerDerivatives<V> corner_by_stretches(const M& material, const Matrix3<V>& f, const V (&gradient)[3],
                                         const V& volume) {
  using std::max;
  const V zero(0.0), half(0.5);
  const Svd3<V> parts = svd(f);
  StretchDerivatives<V> at = stretch_derivatives(material, parts.s);
  V w[3], k[3][3];
  for (int p = 0; p < 3; ++p)
    w[p] = madd(gradient[0], parts.v(0, p), madd(gradient[1], parts.v(1, p), gradient[2] * parts.v(2, p)));
  stiffness_detail::FlipAndTwist<V> pair[3];  // of the axes p and p + 1
  for (int p = 0; p < 3; ++p) {
    pair[p] = stiffness_detail::flip_and_twist<M>(at, parts.s, p, (p + 1) % 3);
    pair[p] = {max(pair[p].flip, zero), max(pair[p].twist, zero)};
  }
  if (stiffness_detail::some_indefinite(at.second)) stiffness_detail::clamp_eigenvalues(at.second);
  for (int p = 0; p < 3; ++p) k[p][p] = at.second[p][p] * w[p] * w[p];
  for (int p = 0; p < 3; ++p) {
    const int q = (p + 1) % 3;
    const V mean = half * (pair[p].flip + pair[p].twist), skew = half * (pair[p].flip - pair[p].twist);
    k[p][p] = madd(mean, w[q] * w[q], k[p][p]);
    k[q][q] = madd(mean, w[p] * w[p], k[q][q]);
    k[p][q] = k[q][p] = (at.second[p][q] + skew) * w[p] * w[q];
  }
  CornerDerivatives<V> result;
  for (int i = 0, to = 0; i < 3; ++i) {
    V row[3], sum = zero;
    for (int q = 0; q < 3; ++q) {
      row[q] = volume * madd(parts.u(i, 0), k[0][q], madd(parts.u(i, 1), k[1][q], parts.u(i, 2) * k[2][q]));
      sum = madd(parts.u(i, q), at.slope[q] * w[q], sum);
    }
    result.force[i] = volume * sum;
    for (int j = 0; j <= i; ++j, ++to)
      result.block[to] = madd(row[0], parts.u(j, 0), madd(row[1], parts.u(j, 1), row[2] * parts.u(j, 2)));
  }
  return result;
}

// Finds the derivatives at corner 1. The block is that of the element's nearest positive semi-definite Hessian; of a
// material that is a formula in F, it is that of the Hessian itself wherever this block is positive semi-definite
// (Sylvester's criterion). fibre: null for none.
template <class M, class V>
CornerDerivatives<V> tetrahedron_corner(const M& material, const Fibre* fibre, const V (&x)[4][3],
                                        const V (&field)[Tetrahedron::fields]) {
  const V gradient[3] = {field[0], field[1], field[2]};
  const Matrix3<V> f = deformation_gradient(x, field);
  using std::min;
  CornerDerivatives<V> result;
  if constexpr (M::needs == Needs::deformation_gradient) {
    result = corner_by_duals(material, f, gradient, field[9]);
    const V(&b)[6] = result.block;
    const V second = b[0] * b[2] - b[1] * b[1];
    const V third = b[3] * (b[1] * b[4] - b[2] * b[3]) + b[4] * (b[1] * b[3] - b[0] * b[4]) + b[5] * second;
    const V least = min(b[0], min(second, third));
    const auto indefinite = least < V(0.0);
    if (some(indefinite)) {
      const CornerDerivatives<V> projected = corner_by_stretches(material, f, gradient, field[9]);
      for (int n = 0; n < 6; ++n) result.block[n] = choose(indefinite, projected.block[n], result.block[n]);
    }
  } else {
    result = corner_by_stretches(material, f, gradient, field[9]);
  }
  if (fibre != nullptr) add_fibre_corner(*fibre, f, gradient, field[9], result);
  return result;
}

template <class V>
CornerDerivatives<V> spring_corner(const V (&x)[2][3], const V (&field)[SpringElement::fields]) {
  const SpringElement spring;
  V force[1][3];
  CornerDerivatives<V> result;
  spring.energy(x, field, force);
  for (int c = 0; c < 3; ++c) result.force[c] = force[0][c];
  spring.stiffness(x, field, true, result.block);
  return result;
}

// Finds the derivatives at corner 1 of a triangle of cloth. The block is that of its projected Hessian.
template <class M, class V>
CornerDerivatives<V> triangle_corner(const M& sheet, const V (&x)[3][3], const V (&field)[Triangle::fields]) {
  const TriangleFormula<M> triangle(sheet);
  V force[2][3], packed[packed_size(6)];
  CornerDerivatives<V> result;
  triangle.energy(x, field, force);
  triangle.stiffness(x, field, true, packed);
  for (int c = 0; c < 3; ++c) result.force[c] = force[0][c];
  for (int n = 0; n < 6; ++n) result.block[n] = packed[n];
  return result;
}

}  // namespace supple
