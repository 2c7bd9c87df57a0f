// Computes the singular value decomposition F = U diag(s) V^T of 3 x 3 matrices, one in each SIMD lane, with det U =
// det V = 1: the largest value comes first, and the smallest carries the sign of det F (Liu et al. 2017, section 3).
// Materials that are written in principal stretches need it. The method is one-sided Jacobi (Hestenes 1958; Demmel and
// Veselic 1992, "Jacobi's method is more accurate than QR"): the columns of F V are rotated pairwise until they are
// orthogonal, so that nothing is squared and small values keep their digits beside large ones. For every finite F: |U S
// V^T - F| <= 32 eps |F|, U and V orthogonal to 16 eps (tested on ten million matrices).
#pragma once

#include "sim/materials/small_matrix.h"

namespace supple {

template <class V>
struct Svd3 {
  Matrix3<V> u, v;  // columns belong to the values
  V s[3];           // s[0] >= s[1] >= |s[2]|
};

namespace svd_detail {

template <class V>
V dot(const V (&a)[3], const V (&b)[3]) {
  return madd(a[0], b[0], madd(a[1], b[1], a[2] * b[2]));
}

// Holds the columns of F V and of V while they are rotated.
template <class V>
struct Columns {
  V b[3][3];
  V v[3][3];
};

// Rotates columns p and q so that the two columns of F V become orthogonal; returns true when they were not orthogonal
// yet in some lane.
template <class V>
bool turn(Columns<V>& columns, int p, int q) {
  using std::sqrt;
  const V squared_p = dot(columns.b[p], columns.b[p]), squared_q = dot(columns.b[q], columns.b[q]);
  const V product = dot(columns.b[p], columns.b[q]);
  constexpr double orthogonal =
      is_single<V> ? 0x1p-21 : 0x1p-50;  // cosine; a dot product's own round-off is half of it
  const auto turning = product * product > V(orthogonal * orthogonal) * squared_p * squared_q;
  if (!some(turning)) return false;
  // This is the smaller root t of t^2 + 2 zeta t - 1 = 0, zeta = (q.q - p.p) / (2 p.q), written so that nothing
  // cancels.
  const V difference = squared_q - squared_p, twice = product + product;
  const V root = sqrt(madd(difference, difference, twice * twice));
  const V below = difference + choose(difference < V(0.0), V(0.0) - root, root);
  const V t = choose(turning, twice / choose(turning, below, V(1.0)), V(0.0));
  const V c = V(1.0) / sqrt(madd(t, t, V(1.0))), s = c * t;
  for (int i = 0; i < 3; ++i) {
    for (auto* pair : {&columns.b, &columns.v}) {
      const V at_p = (*pair)[p][i], at_q = (*pair)[q][i];
      (*pair)[p][i] = madd(c, at_p, V(0.0) - s * at_q);
      (*pair)[q][i] = madd(s, at_p, c * at_q);
    }
  }
  return true;
}

// Exchanges two columns where the second is the longer one; a change of sign keeps det V.
template <class V>
void order(Columns<V>& columns, V (&length2)[3], int p, int q) {
  const auto wrong = length2[p] < length2[q];
  for (auto* pair : {&columns.b, &columns.v}) {
    for (int i = 0; i < 3; ++i) {
      const V at_p = (*pair)[p][i], at_q = (*pair)[q][i];
      (*pair)[p][i] = choose(wrong, at_q, at_p);
      (*pair)[q][i] = choose(wrong, V(0.0) - at_p, at_q);
    }
  }
  const V short_one = choose(wrong, length2[p], length2[q]);
  length2[p] = choose(wrong, length2[q], length2[p]);
  length2[q] = short_one;
}

// Writes a unit vector orthogonal to the unit vector a to `result`: the axis along which a is smallest, made
// orthogonal.
template <class V>
void across(const V (&a)[3], V (&result)[3]) {
  using std::abs;
  using std::sqrt;
  const auto x_least = (abs(a[0]) <= abs(a[1])) & (abs(a[0]) <= abs(a[2]));
  const auto y_least = abs(a[1]) <= abs(a[2]);
  const V axis[3] = {choose(x_least, V(1.0), V(0.0)), choose(x_least, V(0.0), choose(y_least, V(1.0), V(0.0))),
                     choose(x_least, V(0.0), choose(y_least, V(0.0), V(1.0)))};
  const V along = dot(a, axis);
  for (int i = 0; i < 3; ++i) result[i] = axis[i] - along * a[i];
  const V inverse = V(1.0) / sqrt(dot(result, result));
  for (int i = 0; i < 3; ++i) result[i] = inverse * result[i];
}

}  // namespace svd_detail

template <class V>
Svd3<V> svd(const Matrix3<V>& f) {
  using std::abs;
  using std::max;
  using std::sqrt;
  using namespace svd_detail;
  // Matrices whose entries are so far from 1 that fourth powers would leave the range of the numbers are scaled first.
  V largest = abs(f.m[0]);
  for (int i = 1; i < 9; ++i) largest = max(largest, abs(f.m[i]));
  V scale(1.0);
  constexpr double least = is_single<V> ? 1e-4 : 1e-60, most = is_single<V> ? 1e8 : 1e60;
  const auto far = ((largest > V(most)) | (largest < V(least))) & (largest > V(0.0));
  const bool scaled = some(far);
  if (scaled) scale = choose(far, largest, scale);
  Columns<V> columns;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      columns.b[j][i] = scaled ? f(i, j) / scale : f(i, j);
      columns.v[j][i] = V(i == j ? 1.0 : 0.0);
    }
  }
  constexpr int most_sweeps = 12;  // five are enough; columns that differ by many orders of magnitude take a few more
  for (int sweep = 0; sweep < most_sweeps; ++sweep) {
    const bool turned01 = turn(columns, 0, 1), turned02 = turn(columns, 0, 2), turned12 = turn(columns, 1, 2);
    if (!turned01 && !turned02 && !turned12) break;
  }
  V length2[3];
  for (int j = 0; j < 3; ++j) length2[j] = dot(columns.b[j], columns.b[j]);
  order(columns, length2, 0, 1);
  order(columns, length2, 0, 2);
  order(columns, length2, 1, 2);

  // The directions of zero columns are free; below this a squared length has lost digits.
  constexpr double least_squared = is_single<V> ? 1e-30 : 1e-280;
  V u[3][3], other[3];
  const auto first = length2[0] > V(0.0);
  const V inverse0 = V(1.0) / sqrt(choose(first, length2[0], V(1.0)));
  for (int i = 0; i < 3; ++i) u[0][i] = choose(first, columns.b[0][i] * inverse0, V(i == 0 ? 1.0 : 0.0));
  const V along = dot(u[0], columns.b[1]);
  for (int i = 0; i < 3; ++i) u[1][i] = columns.b[1][i] - along * u[0][i];
  const V left = dot(u[1], u[1]);
  const auto second = (left > V(0.25) * length2[1]) & (left > V(least_squared));
  const V inverse1 = V(1.0) / sqrt(choose(second, left, V(1.0)));
  for (int i = 0; i < 3; ++i) u[1][i] = u[1][i] * inverse1;
  if (some(!second)) {
    across(u[0], other);
    for (int i = 0; i < 3; ++i) u[1][i] = choose(second, u[1][i], other[i]);
  }
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    u[2][i] = madd(u[0][j], u[1][k], V(0.0) - u[0][k] * u[1][j]);
  }
  Svd3<V> result;
  for (int j = 0; j < 3; ++j) {
    result.s[j] = dot(u[j], columns.b[j]);
    if (scaled) result.s[j] = result.s[j] * scale;
    for (int i = 0; i < 3; ++i) {
      result.u(i, j) = u[j][i];
      result.v(i, j) = columns.v[j][i];
    }
  }
  return result;
}

// Returns U diag(d) V^T.
template <class V>
Matrix3<V> recomposed(const Svd3<V>& svd, const V (&d)[3]) {
  Matrix3<V> m;
  for (int i = 0; i < 3; ++i) {
    const V scaled[3] = {svd.u(i, 0) * d[0], svd.u(i, 1) * d[1], svd.u(i, 2) * d[2]};
    for (int j = 0; j < 3; ++j) {
      m(i, j) = madd(scaled[0], svd.v(j, 0), madd(scaled[1], svd.v(j, 1), scaled[2] * svd.v(j, 2)));
    }
  }
  return m;
}

}  // namespace supple
