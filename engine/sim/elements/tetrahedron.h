// Defines linear tetrahedra of any material, with additional fibres where a scene has them. Not here: which material an
// element has (element_kernels.cpp dispatches once for each chunk).
#pragma once

#include "sim/elements/polar_rotation.h"
#include "sim/materials/fibre.h"
#include "sim/materials/parameters.h"

namespace supple {

struct Tetrahedron {
  static constexpr int corners = 4;
  static constexpr int fields = 10;  // inverse of the rest edge matrix, row by row [1/m], then the rest volume [m^3]

  static void fill(const double (&rest)[4][3], double (&field)[fields]) {
    Matrix3<double> edges;
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) edges(i, k) = rest[k + 1][i] - rest[0][i];
    }
    const Matrix3<double> cofactors = cofactor(edges);
    const double determ = determinant(edges, cofactors);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) field[3 * i + j] = cofactors(j, i) / determ;
    }
    field[9] = determ / 6;
  }

  // Finds the gradients of the four shape functions, the transpose of G_e [1/m].
  static void shape_gradients(const double (&field)[fields], double (&gradient)[4][3]) {
    for (int j = 0; j < 3; ++j) {
      gradient[0][j] = 0;
      for (int k = 0; k < 3; ++k) {
        gradient[k + 1][j] = field[3 * k + j];
        gradient[0][j] -= field[3 * k + j];
      }
    }
  }
};

// Returns F = (current edges) (rest edges)^-1, as in Sifakis and Barbic 2012, "FEM simulation of 3D deformable solids",
// section 4.
template <class V>
Matrix3<V> deformation_gradient(const V (&x)[4][3], const V (&field)[Tetrahedron::fields]) {
  Matrix3<V> f;
  for (int i = 0; i < 3; ++i) {
    const V edge[3] = {x[1][i] - x[0][i], x[2][i] - x[0][i], x[3][i] - x[0][i]};
    for (int j = 0; j < 3; ++j) f(i, j) = madd(edge[0], field[j], madd(edge[1], field[3 + j], edge[2] * field[6 + j]));
  }
  return f;
}

// Returns the largest singular value of F: the root of the largest eigenvalue of F^T F, in closed form (Smith 1961,
// "Eigenvalues of a symmetric 3 x 3 matrix").
template <class V>
V largest_stretch(const Matrix3<V>& f) {
  using std::acos;
  using std::cos;
  using std::max;
  using std::min;
  using std::sqrt;
  Symmetric3<V> c = symmetric_product(f, f);
  const V mean = (c.xx + c.yy + c.zz) / V(3.0);
  c.xx = c.xx - mean;
  c.yy = c.yy - mean;
  c.zz = c.zz - mean;
  const V spread = sqrt(squared_norm(c) / V(6.0));
  const auto round = !(spread > V(1e-150));
  const V scale = V(1.0) / choose(round, V(1.0), spread);
  for (V* entry : {&c.xx, &c.yy, &c.zz, &c.yz, &c.xz, &c.xy}) *entry = *entry * scale;
  const V half = V(0.5) * determinant(c, cofactor(c));
  const V angle = acos(max(V(-1.0), min(V(1.0), half))) / V(3.0);
  return sqrt(max(V(0.0), choose(round, mean, mean + V(2.0) * spread * cos(angle))));
}

// Finds the energy density and the first Piola-Kirchhoff stress of a material at F by the decomposition that it needs.
template <class M, class V>
V density_of(const M& material, const Matrix3<V>& f, Matrix3<V>& stress) {
  if constexpr (M::needs == Needs::deformation_gradient) {
    return material.density(f, stress);
  } else if constexpr (M::needs == Needs::stretch) {
    const Matrix3<V> r = polar_rotation(f);
    Symmetric3<V> slope;
    const V energy = material.density(symmetric_product(r, f), slope);
    stress = product(r, slope);
    return energy;
  } else {
    const Svd3<V> decomposed = svd(f);
    V slope[3];
    const V energy = material.density(decomposed.s, slope);
    stress = recomposed(decomposed, slope);
    return energy;
  }
}

// Adds the fibres' stress and returns their density. Where F d = 0 its direction is not defined; the force is then
// zero.
template <class V>
V add_fibre(const Fibre& fibre, const Matrix3<V>& f, Matrix3<V>& stress) {
  using std::sqrt;
  const V d[3] = {V(fibre.direction[0]), V(fibre.direction[1]), V(fibre.direction[2])};
  V along[3];
  for (int i = 0; i < 3; ++i) along[i] = madd(f(i, 0), d[0], madd(f(i, 1), d[1], f(i, 2) * d[2]));
  const V length = sqrt(madd(along[0], along[0], madd(along[1], along[1], along[2] * along[2])));
  const auto defined = length > V(1e-150);
  const V excess = length - V(1.0), kappa(fibre.kappa);
  const V tension = choose(defined, kappa * excess / choose(defined, length, V(1.0)), V(0.0));
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) stress(i, j) = madd(tension * along[i], d[j], stress(i, j));
  }
  return V(0.5) * kappa * excess * excess;
}

template <class M, bool with_fibre>
struct TetrahedronFormula : Tetrahedron {
  const M& material;
  const Fibre* fibre;

  TetrahedronFormula(const M& m, const Fibre* along) : material(m), fibre(along) {}

  // Returns the energy [J]; force becomes dE/dx of corners 1 to 3 (that of corner 0 is minus their sum), V P (rest
  // edges)^-T [N].
  template <class V>
  V energy(const V (&x)[4][3], const V (&field)[fields], V (&force)[3][3]) const {
    const Matrix3<V> f = deformation_gradient(x, field);
    Matrix3<V> stress;
    V density = density_of(material, f, stress);
    if constexpr (with_fibre) density = density + add_fibre(*fibre, f, stress);
    const V volume = field[9];
    for (int i = 0; i < 3; ++i) {
      const V p0 = volume * stress(i, 0), p1 = volume * stress(i, 1), p2 = volume * stress(i, 2);
      for (int k = 0; k < 3; ++k)
        force[k][i] = madd(p0, field[3 * k], madd(p1, field[3 * k + 1], p2 * field[3 * k + 2]));
    }
    return volume * density;
  }

  // Finds the largest stretch and the signed volume over the rest volume.
  template <class V>
  void stretch(const V (&x)[4][3], const V (&field)[fields], V& largest, V& volume) const {
    const Matrix3<V> f = deformation_gradient(x, field);
    largest = largest_stretch(f);
    volume = determinant(f, cofactor(f));
  }

  // This function is defined in tetrahedron_stiffness.h.
  template <class V>
  void stiffness(const V (&x)[4][3], const V (&field)[fields], bool project, V (&out)[45]) const;

  // This function is defined in tetrahedron_scalar_stiffness.h.
  template <class V>
  void scalar_stiffness(const V (&x)[4][3], const V (&field)[fields], const V& axial, V (&out)[6]) const;
};

}  // namespace supple
