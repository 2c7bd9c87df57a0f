// Computes the second derivatives of a triangle's energy. In the basis of the singular vectors of F, which is 3 x 2,
// the Hessian of an isotropic sheet separates into a 2 x 2 matrix over the stretches, a flip and a twist in the plane
// (tetrahedron_stiffness.h), and the two ways to turn a direction out of the plane, with the eigenvalues slope_p / s_p.
// The Hessian of a woven sheet is the sum of those of its threads, which are like those of fibres, and of shear.
#pragma once

#include "sim/elements/dual.h"
#include "sim/elements/tetrahedron_stiffness.h"
#include "sim/elements/triangle.h"

namespace supple {

// Holds the second derivatives of an energy by area with respect to the columns a and b of F: packed lower triangles of
// aa and bb, and ab row by row [N/m].
template <class V>
struct PlaneHessian {
  V aa[6], bb[6], ab[9];

  PlaneHessian() {
    for (V& value : aa) value = V(0.0);
    for (V& value : bb) value = V(0.0);
    for (V& value : ab) value = V(0.0);
  }

  // Adds weight m m^T for the motion m with the columns `direction` v0 and `direction` v1.
  void add(const V& weight, const V (&direction)[3], const V& v0, const V& v1) {
    const V w00 = weight * v0 * v0, w01 = weight * v0 * v1, w11 = weight * v1 * v1;
    for (int i = 0, at = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) ab[3 * i + j] = madd(w01 * direction[i], direction[j], ab[3 * i + j]);
      for (int j = 0; j <= i; ++j, ++at) {
        aa[at] = madd(w00 * direction[i], direction[j], aa[at]);
        bb[at] = madd(w11 * direction[i], direction[j], bb[at]);
      }
    }
  }

  // Adds weight m m^T for the motion with the columns a and b.
  void add_motion(const V& weight, const V (&a)[3], const V (&b)[3]) {
    for (int i = 0, at = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) ab[3 * i + j] = madd(weight * a[i], b[j], ab[3 * i + j]);
      for (int j = 0; j <= i; ++j, ++at) {
        aa[at] = madd(weight * a[i], a[j], aa[at]);
        bb[at] = madd(weight * b[i], b[j], bb[at]);
      }
    }
  }
};

namespace stiffness_detail {

template <class V>
struct SheetDerivatives {
  V slope[2], second[2][2];  // [N/m]
};

template <class M, class V>
SheetDerivatives<V> sheet_derivatives(const M& sheet, const V (&s)[2]) {
  using D = Dual<V>;
  const D x[2] = {D::variable(s[0], 0), D::variable(s[1], 1)};
  D slope[2];
  sheet.density(x, slope);
  SheetDerivatives<V> result;
  for (int i = 0; i < 2; ++i) {
    result.slope[i] = slope[i].value;
    for (int j = 0; j < 2; ++j) result.second[i][j] = V(0.5) * (slope[i].d[j] + slope[j].d[i]);
  }
  return result;
}

// Replaces a symmetric 2 x 2 matrix by the nearest positive semi-definite one.
template <class V>
void clamp_two(V (&h)[2][2]) {
  using std::max;
  using std::sqrt;
  const V half(0.5), zero(0.0), mean = half * (h[0][0] + h[1][1]), apart = half * (h[0][0] - h[1][1]);
  const V radius = sqrt(madd(apart, apart, h[0][1] * h[0][1]));
  const V high = max(mean + radius, zero), low = max(mean - radius, zero);
  const auto equal = !(radius > V(1e-30));
  const V scale = choose(equal, zero, half * (high - low) / choose(equal, V(1.0), radius));
  const V middle = half * (high + low);
  h[0][0] = madd(scale, apart, middle);
  h[1][1] = madd(V(0.0) - scale, apart, middle);
  h[0][1] = h[1][0] = scale * h[0][1];
}

// Holds the singular vectors of F: v in the flat pattern, u and the normal in the world.
template <class V>
struct SheetBasis {
  V v[2][2];  // v[p]: direction of stretch p
  V u[3][3];  // u[2]: the normal

  SheetBasis(const PlaneColumns<V>& f, const PlaneStretches<V>& parts) {
    using std::abs;
    using std::max;
    using std::sqrt;
    const V half(0.5), one(1.0), zero(0.0);
    // (cos 2 phi, sin 2 phi) = (across, along) where v0 = (cos phi, sin phi).
    const V cosine = sqrt(max(half * (one + parts.across), zero)), sine = sqrt(max(half * (one - parts.across), zero));
    v[0][0] = cosine;
    v[0][1] = choose(parts.along < zero, zero - sine, sine);
    const auto equal = !(abs(parts.across) + abs(parts.along) > half);
    v[0][0] = choose(equal, one, v[0][0]);
    v[0][1] = choose(equal, zero, v[0][1]);
    v[1][0] = zero - v[0][1];
    v[1][1] = v[0][0];
    for (int i = 0; i < 3; ++i) u[0][i] = madd(f.of[0][i], v[0][0], f.of[1][i] * v[0][1]);
    normalize(u[0], V(1e-8));
    for (int i = 0; i < 3; ++i) u[1][i] = madd(f.of[0][i], v[1][0], f.of[1][i] * v[1][1]);
    const V along = dot_of(u[0], u[1]);
    for (int i = 0; i < 3; ++i) u[1][i] = u[1][i] - along * u[0][i];
    // A sheet without width takes any direction across.
    V other[3];
    const auto x_is_least = abs(u[0][0]) < V(0.6);
    cross(u[0], choose(x_is_least, one, zero), choose(x_is_least, zero, one), other);
    const auto flat = dot_of(u[1], u[1]) < V(1e-14);
    for (int i = 0; i < 3; ++i) u[1][i] = choose(flat, other[i], u[1][i]);
    normalize(u[1], V(1e-30));
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      u[2][i] = madd(u[0][j], u[1][k], zero - u[0][k] * u[1][j]);
    }
  }

 private:
  static void normalize(V (&a)[3], const V& least) {
    using std::max;
    using std::sqrt;
    const V scale = V(1.0) / max(sqrt(dot_of(a, a)), least);
    for (V& value : a) value = value * scale;
  }
  // Computes a x (x, y, 0).
  static void cross(const V (&a)[3], const V& x, const V& y, V (&out)[3]) {
    out[0] = V(0.0) - a[2] * y;
    out[1] = a[2] * x;
    out[2] = a[0] * y - a[1] * x;
  }
};

// Returns flip and twist of an isotropic sheet in its plane.
template <class V>
FlipAndTwist<V> flip_and_twist_of_sheet(const SheetDerivatives<V>& at, const V (&s)[2]) {
  const V half(0.5), difference = s[0] - s[1];
  const auto equal = difference < V(1e-5);
  return {choose(equal, half * (at.second[0][0] + at.second[1][1]) - at.second[0][1],
                 (at.slope[0] - at.slope[1]) / choose(equal, V(1.0), difference)),
          (at.slope[0] + at.slope[1]) / (s[0] + s[1])};
}

template <class M, class V>
PlaneHessian<V> sheet_hessian(const M& sheet, const PlaneColumns<V>& f, bool project) {
  using std::max;
  const V zero(0.0), half(0.5);
  const PlaneStretches<V> parts(f);
  const SheetBasis<V> basis(f, parts);
  SheetDerivatives<V> at = sheet_derivatives(sheet, parts.s);
  FlipAndTwist<V> pair = flip_and_twist_of_sheet(at, parts.s);
  V out_of_plane[2] = {at.slope[0] / parts.s[0], at.slope[1] / parts.s[1]};
  if (project) {
    pair = {max(pair.flip, zero), max(pair.twist, zero)};
    clamp_two(at.second);
    for (V& value : out_of_plane) value = max(value, zero);
  }
  PlaneHessian<V> h;
  for (int p = 0; p < 2; ++p) h.add(out_of_plane[p], basis.u[2], basis.v[p][0], basis.v[p][1]);
  // Motions of the plane: u_p v_q^T.
  V columns[2][2][2][3];  // p, q, column
  for (int p = 0; p < 2; ++p) {
    for (int q = 0; q < 2; ++q) {
      for (int c = 0; c < 2; ++c) {
        for (int i = 0; i < 3; ++i) columns[p][q][c][i] = basis.u[p][i] * basis.v[q][c];
      }
    }
  }
  V plus[2][3], minus[2][3];
  for (int c = 0; c < 2; ++c) {
    for (int i = 0; i < 3; ++i) {
      plus[c][i] = columns[0][1][c][i] + columns[1][0][c][i];
      minus[c][i] = columns[0][1][c][i] - columns[1][0][c][i];
    }
  }
  h.add_motion(half * pair.flip, plus[0], plus[1]);
  h.add_motion(half * pair.twist, minus[0], minus[1]);
  // The stretches: h00 m0 m0^T + h11 m1 m1^T + h01 (m0 m1^T + m1 m0^T), the last as the square of m0 + m1 less those of
  // both.
  V sum[2][3];
  for (int c = 0; c < 2; ++c) {
    for (int i = 0; i < 3; ++i) sum[c][i] = columns[0][0][c][i] + columns[1][1][c][i];
  }
  h.add_motion(at.second[0][0] - at.second[0][1], columns[0][0][0], columns[0][0][1]);
  h.add_motion(at.second[1][1] - at.second[0][1], columns[1][1][0], columns[1][1][1]);
  h.add_motion(at.second[0][1], sum[0], sum[1]);
  return h;
}

// Adds weight (v0, v1)^T (v0, v1) (x) 1, with the identity 1 over the coordinates of space.
template <class V>
void add_identity(const V& weight, const V& v0, const V& v1, PlaneHessian<V>& h) {
  for (int i = 0; i < 3; ++i) {
    const int diagonal = packed_index(i, i);
    h.aa[diagonal] = madd(weight * v0, v0, h.aa[diagonal]);
    h.bb[diagonal] = madd(weight * v1, v1, h.bb[diagonal]);
    h.ab[4 * i] = madd(weight * v0, v1, h.ab[4 * i]);
  }
}

// Returns the Hessian of a woven sheet. Where `project`, each thread's part and each of the two parts of shear are
// projected by themselves. With g = a . b, the parts of shear are shear (b, a)(b, a)^T, and shear g times the exchange
// of a and b, which has the positive half shear |g|/2 (1, sign g)^T (1, sign g).
template <class V>
PlaneHessian<V> sheet_hessian(const Woven& sheet, const PlaneColumns<V>& f, bool project) {
  using std::abs;
  using std::max;
  using std::sqrt;
  const V zero(0.0), one(1.0), half(0.5), shear(sheet.shear);
  PlaneHessian<V> h;
  for (int t = 0; t < 2; ++t) {
    const V length = sqrt(max(dot_of(f.of[t], f.of[t]), V(1e-16)));
    const auto tension = sheet.tension(length, sheet.along(t));
    V across = tension.slope / length, direction[3];
    if (project) across = max(across, zero);
    for (int i = 0; i < 3; ++i) direction[i] = f.of[t][i] / length;
    const V v0 = t == 0 ? one : zero, v1 = t == 0 ? zero : one;
    h.add(tension.second - across, direction, v0, v1);
    add_identity(across, v0, v1, h);
  }
  h.add_motion(shear, f.of[1], f.of[0]);
  const V sine = shear * dot_of(f.of[0], f.of[1]);
  if (project) {
    add_identity(half * abs(sine), one, choose(sine < zero, V(-1.0), one), h);
  } else {
    for (int i = 0; i < 3; ++i) h.ab[4 * i] = h.ab[4 * i] + sine;
  }
  return h;
}

// Writes a third of the traces of aa, ab and bb of the projected Hessian. The stiffness along each principal axis, or
// along each thread of a woven sheet, is at least `axial` times what a stretch along it alone meets: the second
// derivative by this stretch, or the thread's stiffness.
template <class M, class V>
void sheet_scalar(const M& sheet, const PlaneColumns<V>& f, const V& axial, V (&scalar)[3]) {
  using std::max;
  const V zero(0.0), half(0.5), third(1.0 / 3);
  if constexpr (M::isotropic) {
    const PlaneStretches<V> parts(f);
    const SheetBasis<V> basis(f, parts);
    SheetDerivatives<V> at = sheet_derivatives(sheet, parts.s);
    const auto [flip, twist] = flip_and_twist_of_sheet(at, parts.s);
    clamp_two(at.second);
    const V mean = half * (max(flip, zero) + max(twist, zero));
    for (V& value : scalar) value = zero;
    for (int p = 0; p < 2; ++p) {
      const V straight = at.second[p][p];
      const V kappa = max(third * (straight + mean + max(at.slope[p] / parts.s[p], zero)), axial * straight);
      scalar[0] = madd(kappa * basis.v[p][0], basis.v[p][0], scalar[0]);
      scalar[1] = madd(kappa * basis.v[p][0], basis.v[p][1], scalar[1]);
      scalar[2] = madd(kappa * basis.v[p][1], basis.v[p][1], scalar[2]);
    }
  } else {
    const PlaneHessian<V> h = sheet_hessian(sheet, f, true);
    scalar[0] = third * (h.aa[0] + h.aa[2] + h.aa[5]);
    scalar[1] = third * (h.ab[0] + h.ab[4] + h.ab[8]);
    scalar[2] = third * (h.bb[0] + h.bb[2] + h.bb[5]);
    for (int t = 0; t < 2; ++t) scalar[2 * t] = max(scalar[2 * t], axial * V(sheet.along(t)));
  }
}

}  // namespace stiffness_detail

// Writes d^2 E / dx^2 of corners 1 and 2 (6 x 6, packed; corner 0 follows from translations) [N/m]. Where `project`,
// the Hessian in F is replaced first: for isotropic sheets by the nearest positive semi-definite matrix, for woven ones
// by the sum of the nearest ones to its parts (threads, shear).
template <class M>
template <class V>
void TriangleFormula<M>::stiffness(const V (&x)[3][3], const V (&field)[fields], bool project, V (&out)[21]) const {
  const PlaneHessian<V> h = stiffness_detail::sheet_hessian(sheet, plane_gradient(x, field), project);
  for (int k = 0; k < 2; ++k) {
    for (int l = 0; l <= k; ++l) {
      const V g00 = field[4] * field[2 * k] * field[2 * l], g11 = field[4] * field[2 * k + 1] * field[2 * l + 1];
      const V g01 = field[4] * field[2 * k] * field[2 * l + 1], g10 = field[4] * field[2 * k + 1] * field[2 * l];
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
          if (k == l && j > i) continue;
          const int own = i >= j ? packed_index(i, j) : packed_index(j, i);
          out[packed_index(3 * k + i, 3 * l + j)] =
              madd(g00, h.aa[own], madd(g11, h.bb[own], madd(g01, h.ab[3 * i + j], g10 * h.ab[3 * j + i])));
        }
      }
    }
  }
}

template <class M>
template <class V>
void TriangleFormula<M>::scalar_stiffness(const V (&x)[3][3], const V (&field)[fields], const V& axial,
                                          V (&out)[3]) const {
  V scalar[3];
  stiffness_detail::sheet_scalar(sheet, plane_gradient(x, field), axial, scalar);
  for (int k = 0; k < 2; ++k) {
    for (int l = 0; l <= k; ++l) {
      const V straight = madd(field[2 * k] * field[2 * l], scalar[0], field[2 * k + 1] * field[2 * l + 1] * scalar[2]);
      const V cross = madd(field[2 * k], field[2 * l + 1], field[2 * k + 1] * field[2 * l]);
      out[packed_index(k, l)] = field[4] * madd(cross, scalar[1], straight);
    }
  }
}

}  // namespace supple
