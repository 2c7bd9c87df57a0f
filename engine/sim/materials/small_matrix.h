// Defines 3 x 3 matrices whose entries may be SIMD registers (one matrix in each lane), plain doubles, or numbers with
// derivatives (elements/dual.h). The operations of a register are found by its type, so that only those who compute
// with registers include a SIMD library. This header is free of Eigen, so that it can be compiled for several
// instruction sets in one program.
#pragma once

#include <cmath>
#include <cstddef>
#include <type_traits>

namespace supple {

// Tells whether numbers of this type have single precision.
template <class V>
constexpr bool is_single = requires { requires sizeof(typename V::value_type) == sizeof(float); };

// Returns a b + c: fused for registers where the machine can do that, and plain for doubles.
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

// Tells whether the condition holds in any lane.
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
  V row[3];  // summed apart, so that no sum waits for another one
  for (int i = 0; i < 3; ++i) row[i] = madd(a(i, 0), a(i, 0), madd(a(i, 1), a(i, 1), a(i, 2) * a(i, 2)));
  return row[0] + row[1] + row[2];
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

// Returns a^T b where that is known to be symmetric (the stretch of a polar decomposition), as the mean of its entries
// above and below the diagonal.
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

// Returns a b for symmetric matrices that commute (powers of one matrix), whose product is also symmetric.
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

}  // namespace supple
