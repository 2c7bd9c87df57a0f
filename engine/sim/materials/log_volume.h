// Defines the volume term that Neo-Hookean and Mooney-Rivlin share: c(J) = -linear log J + lambda/2 log^2 J (Liu et al.
// 2017, equation 14). Below J = 0.1 the whole of c continues as its second-order Taylor polynomial about 0.1: value,
// slope and curvature are continuous, and with the stress written by the cofactor of F everything stays finite for flat
// and inverted elements. States above 0.1 are unaffected. beyond_linear() returns c(J) + linear (J - 1), which vanishes
// at rest to second order and so keeps its digits there; the materials add the linear part to terms that cancel it
// (near_rest.h).
#pragma once

#include <cmath>

#include "sim/materials/small_matrix.h"

namespace supple {

struct LogVolume {
  static constexpr double smallest_ratio = 0.1;
  double linear, lambda;  // [Pa]

  // Returns c(J) + linear (J - 1); `slope` becomes c'(J).
  template <class V>
  V beyond_linear(const V& j, V& slope) const {
    using std::log;
    using std::max;
    const V least(smallest_ratio);
    const V inside = max(j, least), log_j = log(inside), below = j - least;
    const Taylor at = taylor();
    const auto outside = below < V(0.0);
    slope = choose(outside, madd(V(at.curvature), below, V(at.slope)), madd(V(lambda), log_j, V(-linear)) / inside);
    return choose(
        outside, madd(below, madd(V(0.5 * at.curvature), below, V(at.slope)), madd(V(linear), j - V(1.0), V(at.value))),
        madd(V(linear), inside - V(1.0) - log_j, V(0.5 * lambda) * log_j * log_j));
  }

 private:
  struct Taylor {
    double value, slope, curvature;
  };
  [[gnu::always_inline]] Taylor taylor() const {
    const double j = smallest_ratio, log_j = std::log(j);
    return {-linear * log_j + 0.5 * lambda * log_j * log_j, (lambda * log_j - linear) / j,
            (linear + lambda - lambda * log_j) / (j * j)};
  }
};

}  // namespace supple
