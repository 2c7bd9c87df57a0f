// Computes the part of a tetrahedron's second derivatives that is the same for x, y and z. Of all matrices of the form
// S (x) I_3 the nearest to a Hessian H in the Frobenius norm has S_ij = tr(H_ij) / 3 over the 3 x 3 blocks H_ij (Van
// Loan and Pitsianis 1993, "Approximation with Kronecker products"). For one element, S is V G^T K G with the symmetric
// tensor K_ab = 1/3 sum_i d^2 psi / (dF_ia dF_ib), which is diagonal along the right singular vectors of F. There
// kappa_b = 1/3 sum_a h_ab: h_bb is the diagonal of the Hessian over the stretches, and h_ab the mean of flip and twist
// of the axes a and b (tetrahedron_stiffness.h). Like the Hessian's own trace, S does not change when the body turns.
#pragma once

#include "sim/elements/tetrahedron_stiffness.h"

namespace supple {
namespace stiffness_detail {

// Tells whether a symmetric matrix has a negative leading minor in some lane (Sylvester's criterion).
template <class V>
bool some_indefinite(const V (&h)[3][3]) {
  const V zero(0.0);
  const V second = h[0][0] * h[1][1] - h[0][1] * h[0][1];
  const V third = h[0][2] * (h[0][1] * h[1][2] - h[1][1] * h[0][2]) +
                  h[1][2] * (h[0][1] * h[0][2] - h[0][0] * h[1][2]) + h[2][2] * second;
  return some(h[0][0] < zero) || some(second < zero) || some(third < zero);
}

// Adds V kappa (1 + 2 (1 - 1/l)) / 3 (G^T d)(G^T d)^T, a third of the traces of the fibre's part, where l = |F d|, and
// 1 - 1/l counts as 0 for l < 1. The factor before (G^T d)(G^T d)^T is at least `axial` V kappa.
template <class V>
void add_scalar_fibre(const Fibre& fibre, const Matrix3<V>& f, const V (&field)[Tetrahedron::fields], const V& axial,
                      V* out) {
  using std::max;
  using std::sqrt;
  const V zero(0.0), one(1.0);
  const V d[3] = {V(fibre.direction[0]), V(fibre.direction[1]), V(fibre.direction[2])};
  V n[3], c[3];
  for (int i = 0; i < 3; ++i) n[i] = madd(f(i, 0), d[0], madd(f(i, 1), d[1], f(i, 2) * d[2]));
  for (int k = 0; k < 3; ++k) c[k] = madd(field[3 * k], d[0], madd(field[3 * k + 1], d[1], field[3 * k + 2] * d[2]));
  const V length = max(sqrt(madd(n[0], n[0], madd(n[1], n[1], n[2] * n[2]))), V(1e-8));
  const V across = max(one - one / length, zero);
  const V factor = V(fibre.kappa) * field[9] * max(V(1.0 / 3) * madd(V(2.0), across, one), axial);
  add_outer(factor, c, out);
}

}  // namespace stiffness_detail

// Writes tr(H_ab) / 3 of the projected Hessian over corners 1 to 3 (packed lower triangle; corner 0 follows from
// translations). kappa_b is raised to `axial` h_bb where it is less [N/m].
template <bool with_fibre, class M, class V>
void tetrahedron_scalar_stiffness(const M& material, const Fibre* fibre, const V (&x)[4][3],
                                  const V (&field)[Tetrahedron::fields], const V& axial, V (&out)[packed_size(3)]) {
  using std::max;
  const V zero(0.0), half(0.5), volume = field[9];
  const Matrix3<V> f = deformation_gradient(x, field);
  const stiffness_detail::SingularBasis<V> basis(f, field);
  StretchDerivatives<V> at = stretch_derivatives(material, basis.parts.s);
  V kappa[3] = {zero, zero, zero};
  for (int p = 0; p < 3; ++p) {
    const int q = (p + 1) % 3;
    const auto [flip, twist] = stiffness_detail::flip_and_twist<M>(at, basis.parts.s, p, q);
    const V mean = half * (max(flip, zero) + max(twist, zero));
    kappa[p] = kappa[p] + mean;
    kappa[q] = kappa[q] + mean;
  }
  if (stiffness_detail::some_indefinite(at.second)) stiffness_detail::clamp_eigenvalues(at.second);
  for (int p = 0; p < 3; ++p) {
    const V along = max(at.second[p][p], zero);
    kappa[p] = volume * max(V(1.0 / 3) * (kappa[p] + along), axial * along);
  }
  for (int k = 0; k < 3; ++k) {
    for (int l = 0; l <= k; ++l) {
      V sum = zero;
      for (int p = 0; p < 3; ++p) sum = madd(kappa[p] * basis.w(k, p), basis.w(l, p), sum);
      out[packed_index(k, l)] = sum;
    }
  }
  if constexpr (with_fibre) stiffness_detail::add_scalar_fibre(*fibre, f, field, axial, out);
}

template <class M, bool with_fibre>
template <class V>
void TetrahedronFormula<M, with_fibre>::scalar_stiffness(const V (&x)[4][3], const V (&field)[fields], const V& axial,
                                                         V (&out)[6]) const {
  tetrahedron_scalar_stiffness<with_fibre>(material, fibre, x, field, axial, out);
}

}  // namespace supple
