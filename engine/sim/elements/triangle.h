// Defines linear triangles of cloth: F is 3 x 2, from the flat pattern to the world. Not here: which material a
// triangle has (element_kernels.cpp dispatches once for each chunk), its second derivatives (triangle_stiffness.h), and
// bending (model/bending.h).
#pragma once

#include "sim/materials/membrane.h"

namespace supple {

struct Triangle {
  static constexpr int corners = 3;
  static constexpr int fields = 5;  // inverse of the flat edge matrix, row by row [1/m], then the area at rest [m^2]

  // edges: the flat edges from corner 0 to corners 1 and 2, as columns, row by row [m].
  static void fill(const double (&edges)[4], double (&field)[fields]) {
    const double determ = edges[0] * edges[3] - edges[1] * edges[2];
    field[0] = edges[3] / determ;
    field[1] = -edges[1] / determ;
    field[2] = -edges[2] / determ;
    field[3] = edges[0] / determ;
    field[4] = 0.5 * determ;
  }

  // Finds the gradients of the three shape functions [1/m].
  static void shape_gradients(const double* field, double (&gradient)[3][2]) {
    for (int j = 0; j < 2; ++j) {
      gradient[1][j] = field[j];
      gradient[2][j] = field[2 + j];
      gradient[0][j] = -field[j] - field[2 + j];
    }
  }
};

// Holds the columns of F, or of another matrix of its shape, such as the stress.
template <class V>
struct PlaneColumns {
  V of[2][3];
};

template <class V>
PlaneColumns<V> plane_gradient(const V (&x)[3][3], const V (&field)[Triangle::fields]) {
  PlaneColumns<V> f;
  for (int i = 0; i < 3; ++i) {
    const V first = x[1][i] - x[0][i], second = x[2][i] - x[0][i];
    for (int j = 0; j < 2; ++j) f.of[j][i] = madd(first, field[j], second * field[2 + j]);
  }
  return f;
}

template <class V>
V dot_of(const V (&a)[3], const V (&b)[3]) {
  return madd(a[0], b[0], madd(a[1], b[1], a[2] * b[2]));
}

// Holds the two stretches of F and their directions in the flat pattern: the projections on them are (1 + D)/2 and (1 -
// D)/2 with D = [across, along; along, -across]. Where the stretches are equal D is zero.
template <class V>
struct PlaneStretches {
  V s[2];  // s[0] >= s[1] >= 1e-8
  V across, along;

  explicit PlaneStretches(const PlaneColumns<V>& f) {
    using std::max;
    using std::sqrt;
    const V half(0.5), aa = dot_of(f.of[0], f.of[0]), bb = dot_of(f.of[1], f.of[1]), ab = dot_of(f.of[0], f.of[1]);
    const V mean = half * (aa + bb), apart = half * (aa - bb), radius = sqrt(madd(apart, apart, ab * ab));
    // The smaller eigenvalue of F^T F is the squared area over the larger one, which keeps its digits.
    V n[3];
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      n[i] = madd(f.of[0][j], f.of[1][k], V(0.0) - f.of[0][k] * f.of[1][j]);
    }
    const V least(1e-8);
    s[0] = max(sqrt(mean + radius), least);
    s[1] = max(sqrt(dot_of(n, n)) / s[0], least);
    const auto equal = !(radius > V(1e-30));
    const V scale = choose(equal, V(0.0), V(1.0) / choose(equal, V(1.0), radius));
    across = scale * apart;
    along = scale * ab;
  }
};

// Returns the energy by area of an isotropic sheet, and its derivatives with respect to F [N/m].
template <class M, class V>
V sheet_density(const M& sheet, const PlaneColumns<V>& f, PlaneColumns<V>& stress) {
  const PlaneStretches<V> parts(f);
  V slope[2];
  const V energy = sheet.density(parts.s, slope);
  // P = F sum_p (slope_p / s_p) v_p v_p^T
  const V half(0.5), first = slope[0] / parts.s[0], second = slope[1] / parts.s[1];
  const V mean = half * (first + second), apart = half * (first - second);
  const V s00 = madd(apart, parts.across, mean), s11 = madd(V(0.0) - apart, parts.across, mean),
          s01 = apart * parts.along;
  for (int i = 0; i < 3; ++i) {
    stress.of[0][i] = madd(f.of[0][i], s00, f.of[1][i] * s01);
    stress.of[1][i] = madd(f.of[0][i], s01, f.of[1][i] * s11);
  }
  return energy;
}

// Does the same for a woven sheet. A thread of no length has no direction, and pulls nowhere.
template <class V>
V sheet_density(const Woven& sheet, const PlaneColumns<V>& f, PlaneColumns<V>& stress) {
  using std::max;
  using std::sqrt;
  const V sine = dot_of(f.of[0], f.of[1]), sheared = V(sheet.shear) * sine;
  V energy = V(0.5) * sheared * sine;
  for (int t = 0; t < 2; ++t) {
    const V length = sqrt(max(dot_of(f.of[t], f.of[t]), V(1e-16)));
    const auto tension = sheet.tension(length, sheet.along(t));
    const V pull = tension.slope / length;
    energy = energy + tension.energy;
    for (int i = 0; i < 3; ++i) stress.of[t][i] = madd(pull, f.of[t][i], sheared * f.of[1 - t][i]);
  }
  return energy;
}

template <class M>
struct TriangleFormula : Triangle {
  const M& sheet;

  explicit TriangleFormula(const M& m) : sheet(m) {}

  // Returns the energy [J]; force becomes dE/dx of corners 1 and 2 (that of corner 0 is minus their sum) [N].
  template <class V>
  V energy(const V (&x)[3][3], const V (&field)[fields], V (&force)[2][3]) const {
    PlaneColumns<V> stress;
    const V density = sheet_density(sheet, plane_gradient(x, field), stress);
    const V area = field[4];
    for (int i = 0; i < 3; ++i) {
      const V p = area * stress.of[0][i], q = area * stress.of[1][i];
      for (int k = 0; k < 2; ++k) force[k][i] = madd(p, field[2 * k], q * field[2 * k + 1]);
    }
    return area * density;
  }

  // Finds the largest stretch. A triangle in space cannot be inverted; its volume ratio is 1.
  template <class V>
  void stretch(const V (&x)[3][3], const V (&field)[fields], V& largest, V& volume) const {
    largest = PlaneStretches<V>(plane_gradient(x, field)).s[0];
    volume = V(1.0);
  }

  // These functions are defined in triangle_stiffness.h.
  template <class V>
  void stiffness(const V (&x)[3][3], const V (&field)[fields], bool project, V (&out)[21]) const;
  template <class V>
  void scalar_stiffness(const V (&x)[3][3], const V (&field)[fields], const V& axial, V (&out)[3]) const;
};

}  // namespace supple
