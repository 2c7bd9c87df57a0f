// 3 x 3 matrices whose entries may be SIMD registers (one element a lane) or plain doubles (the oracle in the tests),
// and the polar decomposition that the stretch-based materials need. The operations of a register are found by its
// type, so that only those who compute with registers include a SIMD library. Free of Eigen, so that it can be compiled
// for several instruction sets in one program.
#pragma once

#include <cmath>
#include <cstddef>
#include <type_traits>

namespace supple {

// Returns a b + c: fused for registers where the machine can, and plain for the oracle.
inline double madd(double a, double b, double c) { return a * b + c; }
template <class V>
V madd(const V& a, const V& b, const V& c) {
  return fma(a, b, c);
}

// Returns `yes` where the condition holds and `no` elsewhere, lane by lane.
inline double choose(bool condition, double yes, double no) { return condition ? yes : no; }
template <class Condition, class V>
requires(!std::is_arithmetic_v<Condition>) V choose(const Condition& condition, const V& yes, const V& no) {
  return select(condition, yes, no);
}

// Whether the condition holds in any lane.
inline bool some(bool condition) { return condition; }
template <class Condition>
requires(!std::is_arithmetic_v<Condition>) bool some(const Condition& condition) { return any(condition); }

template <class V>
struct Matrix3 {
  V m[9];  // row by row
  V& operator()(int row, int column) { return m[3 * row + column]; }
  const V& operator()(int row, int column) const { return m[3 * row + column]; }
};

template <class V>
struct Symmetric3 {
  V xx, yy, zz, yz, xz, xy;
};

template <class V>
V squared_norm(const Matrix3<V>& a) {
  V sum = a.m[0] * a.m[0];
  for (int i = 1; i < 9; ++i) sum = madd(a.m[i], a.m[i], sum);
  return sum;
}

// Returns the sum of all a_ij^2 of a symmetric matrix.
template <class V>
V squared_norm(const Symmetric3<V>& a) {
  const V diagonal = madd(a.xx, a.xx, madd(a.yy, a.yy, a.zz * a.zz));
  const V off = madd(a.yz, a.yz, madd(a.xz, a.xz, a.xy * a.xy));
  return madd(V(2.0), off, diagonal);
}

// Returns the matrix of cofactors, which is d det(a) / d a and finite for singular matrices.
template <class V>
Matrix3<V> cofactor(const Matrix3<V>& a) {
  Matrix3<V> c;
  for (int i = 0; i < 3; ++i) {
    const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
    for (int j = 0; j < 3; ++j) {
      const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      c(i, j) = madd(a(i1, j1), a(i2, j2), V(0.0) - a(i1, j2) * a(i2, j1));
    }
  }
  return c;
}

template <class V>
Symmetric3<V> cofactor(const Symmetric3<V>& a) {
  const V zero(0.0);
  return {madd(a.yy, a.zz, zero - a.yz * a.yz), madd(a.xx, a.zz, zero - a.xz * a.xz),
          madd(a.xx, a.yy, zero - a.xy * a.xy), madd(a.xy, a.xz, zero - a.xx * a.yz),
          madd(a.xy, a.yz, zero - a.yy * a.xz), madd(a.xz, a.yz, zero - a.zz * a.xy)};
}

template <class V>
V determinant(const Symmetric3<V>& a, const Symmetric3<V>& cofactors) {
  return madd(a.xx, cofactors.xx, madd(a.xy, cofactors.xy, a.xz * cofactors.xz));
}

template <class V>
V determinant(const Matrix3<V>& a, const Matrix3<V>& cofactors) {
  return madd(a(0, 0), cofactors(0, 0), madd(a(0, 1), cofactors(0, 1), a(0, 2) * cofactors(0, 2)));
}

// Returns a^T b where that is known to be symmetric (the stretch of a polar decomposition), the average of both halves.
template <class V>
Symmetric3<V> symmetric_product(const Matrix3<V>& a, const Matrix3<V>& b) {
  const auto entry = [&](int i, int j) { return madd(a(0, i), b(0, j), madd(a(1, i), b(1, j), a(2, i) * b(2, j))); };
  const V half(0.5);
  return {entry(0, 0),
          entry(1, 1),
          entry(2, 2),
          half * (entry(1, 2) + entry(2, 1)),
          half * (entry(0, 2) + entry(2, 0)),
          half * (entry(0, 1) + entry(1, 0))};
}

// Returns a b for symmetric matrices that commute (powers of one matrix), which is symmetric again.
template <class V>
Symmetric3<V> commuting_product(const Symmetric3<V>& a, const Symmetric3<V>& b) {
  return {madd(a.xx, b.xx, madd(a.xy, b.xy, a.xz * b.xz)), madd(a.xy, b.xy, madd(a.yy, b.yy, a.yz * b.yz)),
          madd(a.xz, b.xz, madd(a.yz, b.yz, a.zz * b.zz)), madd(a.xy, b.xz, madd(a.yy, b.yz, a.yz * b.zz)),
          madd(a.xx, b.xz, madd(a.xy, b.yz, a.xz * b.zz)), madd(a.xx, b.xy, madd(a.xy, b.yy, a.xz * b.yz))};
}

template <class V>
Matrix3<V> product(const Matrix3<V>& a, const Symmetric3<V>& s) {
  Matrix3<V> p;
  for (int i = 0; i < 3; ++i) {
    p(i, 0) = madd(a(i, 0), s.xx, madd(a(i, 1), s.xy, a(i, 2) * s.xz));
    p(i, 1) = madd(a(i, 0), s.xy, madd(a(i, 1), s.yy, a(i, 2) * s.yz));
    p(i, 2) = madd(a(i, 0), s.xz, madd(a(i, 1), s.yz, a(i, 2) * s.zz));
  }
  return p;
}

// The rotation R with det R = 1 that maximises tr(R^T F), by Jacobi rotations on the 4 x 4 matrix of its quaternion
// (Horn 1987, "Closed-form solution of absolute orientation using unit quaternions"). Slow, accurate to a few eps for
// every F, and defined (some maximiser) where the two smallest stretches cancel. The fallback of polar_rotation() and
// its oracle. Internal linkage: each instruction set has its own copy.
static inline void polar_rotation_jacobi(const double f[9], double r[9]) {
  double scale = 0;
  for (int i = 0; i < 9; ++i) scale = std::fmax(scale, std::fabs(f[i]));
  double k[4][4] = {}, v[4][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};
  if (scale > 0 && std::isfinite(scale)) {
    double g[9];
    for (int i = 0; i < 9; ++i) g[i] = f[i] / scale;
    k[0][0] = g[0] + g[4] + g[8];
    k[1][1] = g[0] - g[4] - g[8];
    k[2][2] = g[4] - g[0] - g[8];
    k[3][3] = g[8] - g[0] - g[4];
    k[0][1] = k[1][0] = g[7] - g[5];
    k[0][2] = k[2][0] = g[2] - g[6];
    k[0][3] = k[3][0] = g[3] - g[1];
    k[1][2] = k[2][1] = g[1] + g[3];
    k[1][3] = k[3][1] = g[2] + g[6];
    k[2][3] = k[3][2] = g[5] + g[7];
  }
  for (int sweep = 0; sweep < 12; ++sweep) {
    double off = 0;
    for (int p = 0; p < 3; ++p) {
      for (int q = p + 1; q < 4; ++q) off += k[p][q] * k[p][q];
    }
    if (off < 1e-36) break;
    for (int p = 0; p < 3; ++p) {
      for (int q = p + 1; q < 4; ++q) {
        if (k[p][q] == 0) continue;
        const double theta = (k[q][q] - k[p][p]) / (2 * k[p][q]);
        const double t = std::copysign(1 / (std::fabs(theta) + std::sqrt(theta * theta + 1)), theta);
        const double c = 1 / std::sqrt(t * t + 1), s = t * c;
        for (int i = 0; i < 4; ++i) {
          const double a = k[i][p], b = k[i][q];
          k[i][p] = c * a - s * b;
          k[i][q] = s * a + c * b;
        }
        for (int i = 0; i < 4; ++i) {
          const double a = k[p][i], b = k[q][i];
          k[p][i] = c * a - s * b;
          k[q][i] = s * a + c * b;
        }
        for (int i = 0; i < 4; ++i) {
          const double a = v[i][p], b = v[i][q];
          v[i][p] = c * a - s * b;
          v[i][q] = s * a + c * b;
        }
      }
    }
  }
  int best = 0;
  for (int i = 1; i < 4; ++i) {
    if (k[i][i] > k[best][best]) best = i;
  }
  const double norm =
      std::sqrt(v[0][best] * v[0][best] + v[1][best] * v[1][best] + v[2][best] * v[2][best] + v[3][best] * v[3][best]);
  const double w = v[0][best] / norm, x = v[1][best] / norm, y = v[2][best] / norm, z = v[3][best] / norm;
  r[0] = 1 - 2 * (y * y + z * z);
  r[1] = 2 * (x * y - w * z);
  r[2] = 2 * (x * z + w * y);
  r[3] = 2 * (x * y + w * z);
  r[4] = 1 - 2 * (x * x + z * z);
  r[5] = 2 * (y * z - w * x);
  r[6] = 2 * (x * z - w * y);
  r[7] = 2 * (y * z + w * x);
  r[8] = 1 - 2 * (x * x + y * y);
}

// The same rotation in a handful of SIMD operations. Its trace product lambda = tr(R^T F) is the largest root of
//   lambda^4 - 2 I lambda^2 - 8 J lambda + I^2 - 4 II = 0,   I = |F|^2, II = |cof F|^2, J = det F,
// and R = d lambda / d F follows by implicit differentiation (Lin, Chitalu, Komura 2022, "Isotropic ARAP energy using
// Cauchy-Green invariants"). The root is found by Newton from the upper bound sqrt(I + 2 sqrt(3 II)): from there the
// iteration falls monotonically. The formula divides by 2 (s1+s2)(s1+s3)(s2+s3); lanes where that is small, or where
// something overflowed, take the Jacobi path. Elsewhere R is within about 1e-12 of it (the root's own conditioning),
// and near rest within a few eps.
template <class V>
Matrix3<V> polar_rotation(const Matrix3<V>& f) {
  const Matrix3<V> cofactors = cofactor(f);
  const V determ = determinant(f, cofactors);
  const V norm2 = squared_norm(f);
  const V second = squared_norm(cofactors);
  const V two(2.0);
  const V constant = madd(norm2, norm2, V(-4.0) * second);
  V root = sqrt(madd(two, sqrt(V(3.0) * second), norm2));
  auto moving = root > root;
  for (int step = 0; step < 12; ++step) {
    const V square = root * root;
    const V value = madd(square, square - two * norm2, madd(V(-8.0) * determ, root, constant));
    const V quarter_slope = madd(root, square - norm2, V(-2.0) * determ);
    const V change = V(0.25) * value / quarter_slope;
    root = root - change;
    moving = abs(change) > V(1e-9) * root;  // Newton squares what is left: 1e-9 is followed by round-off
    if (!some(moving)) break;
  }
  const V square = root * root;
  const V denominator = madd(root, square - norm2, V(-2.0) * determ);
  const auto safe = (denominator > V(1e-3) * square * root) && !moving;

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

  alignas(64) double lanes_f[9][V::size], lanes_r[9][V::size], lanes_safe[V::size];
  for (int i = 0; i < 9; ++i) {
    f.m[i].store_aligned(lanes_f[i]);
    r.m[i].store_aligned(lanes_r[i]);
  }
  choose(safe, V(1.0), V(0.0)).store_aligned(lanes_safe);
  for (std::size_t lane = 0; lane < V::size; ++lane) {
    if (lanes_safe[lane] != 0) continue;
    double one_f[9], one_r[9];
    for (int i = 0; i < 9; ++i) one_f[i] = lanes_f[i][lane];
    polar_rotation_jacobi(one_f, one_r);
    for (int i = 0; i < 9; ++i) lanes_r[i][lane] = one_r[i];
  }
  for (int i = 0; i < 9; ++i) r.m[i] = V::load_aligned(lanes_r[i]);
  return r;
}

inline Matrix3<double> polar_rotation(const Matrix3<double>& f) {
  Matrix3<double> r;
  polar_rotation_jacobi(f.m, r.m);
  return r;
}

}  // namespace supple
