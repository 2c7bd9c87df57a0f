// Computes the second derivatives of a tetrahedron's energy. In the basis of the singular vectors of F the Hessian of
// an isotropic density separates into a 3 x 3 matrix over the stretches and, for each pair of axes, a flip and a twist
// (Smith, de Goes, Kim 2019, "Analytic eigensystems for isotropic distortion energies", section 4), so the nearest
// positive semi-definite matrix (Teran et al. 2005) costs two clamped numbers for each pair of axes and a 3 x 3
// eigenproblem. Derivatives of the material with respect to stretches come from its own formula (dual.h).
#pragma once

#include "sim/elements/dual.h"
#include "sim/elements/tetrahedron.h"

namespace supple {

// Returns the index of an entry in the packed lower triangle of a symmetric matrix.
constexpr int packed_index(int row, int column) { return row * (row + 1) / 2 + column; }
constexpr int packed_size(int rows) { return rows * (rows + 1) / 2; }

// Holds the first and second derivatives of a density with respect to the stretches.
template <class V>
struct StretchDerivatives {
  V slope[3];      // [Pa]
  V second[3][3];  // [Pa]
};

template <class M, class V>
StretchDerivatives<V> stretch_derivatives(const M& material, const V (&s)[3]) {
  using D = Dual<V>;
  const D x[3] = {D::variable(s[0], 0), D::variable(s[1], 1), D::variable(s[2], 2)};
  D slope[3];
  if constexpr (M::needs == Needs::deformation_gradient) {
    Matrix3<D> f, stress;
    for (int i = 0; i < 3; ++i) f(i, i) = x[i];
    material.density(f, stress);
    for (int i = 0; i < 3; ++i) slope[i] = stress(i, i);
  } else if constexpr (M::needs == Needs::stretch) {
    Symmetric3<D> at, stress;
    at.xx = x[0];
    at.yy = x[1];
    at.zz = x[2];
    material.density(at, stress);
    slope[0] = stress.xx;
    slope[1] = stress.yy;
    slope[2] = stress.zz;
  } else {
    material.density(x, slope);
  }
  StretchDerivatives<V> result;
  for (int i = 0; i < 3; ++i) {
    result.slope[i] = slope[i].value;
    for (int j = 0; j < 3; ++j) result.second[i][j] = V(0.5) * (slope[i].d[j] + slope[j].d[i]);
  }
  return result;
}

namespace stiffness_detail {

// Replaces h by the nearest positive semi-definite matrix, (H + |H|) / 2 with |H| = V |S| V^T from H = U S V^T.
template <class V>
void clamp_eigenvalues(V (&h)[3][3]) {
  using std::abs;
  Matrix3<V> matrix;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) matrix(i, j) = h[i][j];
  }
  const Svd3<V> parts = svd(matrix);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      V sum = h[i][j];
      for (int k = 0; k < 3; ++k) sum = madd(parts.v(i, k) * abs(parts.s[k]), parts.v(j, k), sum);
      h[i][j] = V(0.5) * sum;
    }
  }
}

// Adds factor b b^T to `out`, packed.
template <int n, class V>
void add_outer(const V& factor, const V (&b)[n], V* out) {
  for (int i = 0; i < n; ++i) {
    const V scaled = factor * b[i];
    for (int j = 0; j <= i; ++j) out[packed_index(i, j)] = madd(scaled, b[j], out[packed_index(i, j)]);
  }
}

// Holds F = U diag(s) V^T of an element, and its rest gradients along the right singular vectors.
template <class V>
struct SingularBasis {
  Svd3<V> parts;
  Matrix3<V> w;  // (k, p): the gradient of corner k+1 along v_p [1/m]

  SingularBasis(const Matrix3<V>& f, const V (&field)[Tetrahedron::fields]) : parts(svd(f)) {
    for (int k = 0; k < 3; ++k) {
      for (int p = 0; p < 3; ++p)
        w(k, p) =
            madd(field[3 * k], parts.v(0, p), madd(field[3 * k + 1], parts.v(1, p), field[3 * k + 2] * parts.v(2, p)));
    }
  }
  // Writes dF = u_p v_q^T as a gradient over corners 1 to 3.
  void mode(int p, int q, V (&b)[9]) const {
    for (int k = 0; k < 3; ++k) {
      for (int i = 0; i < 3; ++i) b[3 * k + i] = parts.u(i, p) * w(k, q);
    }
  }
};

template <class V>
struct FlipAndTwist {
  V flip, twist;  // eigenvalues of one pair of axes [Pa]
};

template <class M, class V>
FlipAndTwist<V> flip_and_twist(const StretchDerivatives<V>& at, const V (&s)[3], int p, int q) {
  using std::abs;
  using std::max;
  const V zero(0.0), one(1.0), half(0.5);
  const V difference = s[p] - s[q], sum = s[p] + s[q];
  const V straight = half * (at.second[p][p] + at.second[q][q]), cross = at.second[p][q];
  const V small = V(1e-5) * max(one, abs(s[0]));
  const auto equal = abs(difference) < small;
  FlipAndTwist<V> pair;
  pair.flip = choose(equal, straight - cross, (at.slope[p] - at.slope[q]) / choose(equal, one, difference));
  const auto opposite = abs(sum) < small;
  if constexpr (M::needs == Needs::deformation_gradient) {  // smooth in F
    pair.twist = choose(opposite, straight + cross, (at.slope[p] + at.slope[q]) / choose(opposite, one, sum));
  } else {
    const V least = choose(sum < zero, V(-1e-8), V(1e-8));
    pair.twist = (at.slope[p] + at.slope[q]) / choose(abs(sum) < V(1e-8), least, sum);
  }
  return pair;
}

template <class M, class V>
void add_flips_and_twists(const StretchDerivatives<V>& at, const SingularBasis<V>& basis, const V& volume, bool project,
                          V* out) {
  using std::max;
  const V zero(0.0), half(0.5);
  for (int p = 0; p < 3; ++p) {
    const int q = (p + 1) % 3;
    FlipAndTwist<V> pair = flip_and_twist<M>(at, basis.parts.s, p, q);
    if (project) pair = {max(pair.flip, zero), max(pair.twist, zero)};
    V a[9], b[9], plus[9], minus[9];
    basis.mode(p, q, a);
    basis.mode(q, p, b);
    for (int i = 0; i < 9; ++i) {
      plus[i] = a[i] + b[i];
      minus[i] = a[i] - b[i];
    }
    add_outer(half * volume * pair.flip, plus, out);
    add_outer(half * volume * pair.twist, minus, out);
  }
}

// Adds the part of the Hessian over the stretches. second: second derivatives of the density with respect to the
// stretches, already projected where that is wanted [Pa].
template <class V>
void add_stretches(const V (&second)[3][3], const SingularBasis<V>& basis, const V& volume, V* out) {
  V stretch[3][9];
  for (int p = 0; p < 3; ++p) basis.mode(p, p, stretch[p]);
  for (int i = 0; i < 9; ++i) {
    V along[3];
    for (int p = 0; p < 3; ++p)
      along[p] =
          volume * madd(second[p][0], stretch[0][i], madd(second[p][1], stretch[1][i], second[p][2] * stretch[2][i]));
    for (int j = 0; j <= i; ++j) {
      V& entry = out[packed_index(i, j)];
      entry = madd(along[0], stretch[0][j], madd(along[1], stretch[1][j], madd(along[2], stretch[2][j], entry)));
    }
  }
}

// Adds V kappa (G^T d)(G^T d)^T (x) ((1 - 1/l)(1 - n n^T) + n n^T) with l = |F d|, n = F d / l.
template <class V>
void add_fibre_stiffness(const Fibre& fibre, const Matrix3<V>& f, const V (&field)[Tetrahedron::fields], bool project,
                         V* out) {
  using std::max;
  using std::sqrt;
  const V zero(0.0), one(1.0), volume = field[9];
  const V d[3] = {V(fibre.direction[0]), V(fibre.direction[1]), V(fibre.direction[2])};
  V n[3], c[3];
  for (int i = 0; i < 3; ++i) n[i] = madd(f(i, 0), d[0], madd(f(i, 1), d[1], f(i, 2) * d[2]));
  for (int k = 0; k < 3; ++k) c[k] = madd(field[3 * k], d[0], madd(field[3 * k + 1], d[1], field[3 * k + 2] * d[2]));
  const V length = max(sqrt(madd(n[0], n[0], madd(n[1], n[1], n[2] * n[2]))), V(1e-8));
  V across = one - one / length;
  if (project) across = max(across, zero);
  for (int i = 0; i < 9; ++i) {
    for (int j = 0; j <= i; ++j) {
      const V nn = n[i % 3] * n[j % 3] / (length * length);
      const V part = madd(one - across, nn, i % 3 == j % 3 ? across : zero);
      V& entry = out[packed_index(i, j)];
      entry = madd(V(fibre.kappa) * volume * c[i / 3], c[j / 3] * part, entry);
    }
  }
}

}  // namespace stiffness_detail

// Writes d^2 E / dx^2 of corners 1 to 3 (9 x 9, packed; corner 0 follows from translations), or the nearest positive
// semi-definite matrix; fibres are projected separately. Where two stretches cancel (s_i + s_j = 0) a formula in
// stretches has a kink; the twist is then held at its value at a distance of 1e-8. [N/m]
template <bool with_fibre, class M, class V>
void tetrahedron_stiffness(const M& material, const Fibre* fibre, const V (&x)[4][3],
                           const V (&field)[Tetrahedron::fields], bool project, V (&out)[packed_size(9)]) {
  const Matrix3<V> f = deformation_gradient(x, field);
  const stiffness_detail::SingularBasis<V> basis(f, field);
  StretchDerivatives<V> at = stretch_derivatives(material, basis.parts.s);
  const V volume = field[9];
  for (V& value : out) value = V(0.0);
  stiffness_detail::add_flips_and_twists<M>(at, basis, volume, project, out);
  if (project) stiffness_detail::clamp_eigenvalues(at.second);
  stiffness_detail::add_stretches(at.second, basis, volume, out);
  if constexpr (with_fibre) stiffness_detail::add_fibre_stiffness(*fibre, f, field, project, out);
}

template <class M, bool with_fibre>
template <class V>
void TetrahedronFormula<M, with_fibre>::stiffness(const V (&x)[4][3], const V (&field)[fields], bool project,
                                                  V (&out)[45]) const {
  tetrahedron_stiffness<with_fibre>(material, fibre, x, field, project, out);
}

}  // namespace supple
