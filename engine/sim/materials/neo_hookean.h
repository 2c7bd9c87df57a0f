// Compressible Neo-Hookean material (Liu et al. 2017, equation 14): Psi = mu/2 (tr F^T F - 3) + c(J), c(J) = -mu log J
// + lambda/2 log^2 J. Below J = 0.1 the whole of c continues as its second-order Taylor polynomial there: value, slope
// and curvature are continuous, and with the stress written by the cofactor of F everything stays finite for flat and
// inverted elements. States above 0.1 are unaffected.
#pragma once

#include <array>
#include <cmath>

#include "sim/materials/parameters.h"
#include "sim/small_matrix.h"

namespace supple {

struct NeoHookean {
  static constexpr std::string_view name = "neo-hookean";
  static constexpr Needs needs = Needs::gradient;
  static constexpr double smallest_volume_ratio = 0.1;
  double mu = 0;
  double lambda = 0;

  static constexpr auto parameters() {
    return std::array{Parameter<NeoHookean>{"mu", "Pa", "shear modulus", &NeoHookean::mu, false},
                      Parameter<NeoHookean>{"lambda", "Pa", "first Lame parameter", &NeoHookean::lambda, true}};
  }

  // c, c' and c'' at the J where the extension begins.
  struct Extension {
    double value, slope, curvature;
  };
  [[gnu::always_inline]] Extension extension() const {
    const double j = smallest_volume_ratio, log_j = std::log(j);
    return {-mu * log_j + 0.5 * lambda * log_j * log_j, (lambda * log_j - mu) / j,
            (mu + lambda - lambda * log_j) / (j * j)};
  }

  template <class V>
  V density(const Matrix3<V>& f, Matrix3<V>& stress) const {
    using std::log;
    using std::max;
    const Matrix3<V> cofactors = cofactor(f);
    const V j = determinant(f, cofactors);
    const Extension at = extension();
    const V least(smallest_volume_ratio);
    const V log_j = log(max(j, least));
    const V below = j - least;
    const V value_above = log_j * madd(V(0.5 * lambda), log_j, V(-mu));
    const V value_below = madd(below, madd(V(0.5 * at.curvature), below, V(at.slope)), V(at.value));
    const V slope_above = madd(V(lambda), log_j, V(-mu)) / max(j, least);
    const V slope_below = madd(V(at.curvature), below, V(at.slope));
    const V value = choose(below < V(0.0), value_below, value_above);
    const V slope = choose(below < V(0.0), slope_below, slope_above);
    for (int i = 0; i < 9; ++i) stress.m[i] = madd(V(mu), f.m[i], slope * cofactors.m[i]);
    return madd(V(0.5 * mu), squared_norm(f) - V(3.0), value);
  }

  // From a = mu/2 (s^2 - 1) and c, with the extension of c.
  double axial_stress(double s) const {
    const Extension at = extension();
    const double slope = s < smallest_volume_ratio ? at.slope + at.curvature * (s - smallest_volume_ratio)
                                                   : (lambda * std::log(s) - mu) / s;
    return mu * s + slope;
  }

 private:
  template <class B, class V>
  static V choose(const B& condition, const V& yes, const V& no) {
    return xsimd::select(condition, yes, no);
  }
  static double choose(bool condition, double yes, double no) { return condition ? yes : no; }
};

}  // namespace supple
