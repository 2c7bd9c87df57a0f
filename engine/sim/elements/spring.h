// Defines springs between two vertices, of which mass-spring cloth is made: k/2 (|x_i - x_j| - r)^2 (Liu, Bargteil,
// O'Brien, Kavan 2013, "Fast simulation of mass-spring systems").
#pragma once

#include "sim/materials/small_matrix.h"

namespace supple {

struct SpringElement {
  static constexpr int corners = 2;
  static constexpr int fields = 2;  // rest length r [m], stiffness k [N/m]

  // Returns the energy [J]; force becomes dE/dx of corner 1 (that of corner 0 is its negative) [N]. Ends that coincide
  // have no direction; the force is then zero.
  template <class V>
  V energy(const V (&x)[2][3], const V (&field)[fields], V (&force)[1][3]) const {
    using std::sqrt;
    const V d[3] = {x[1][0] - x[0][0], x[1][1] - x[0][1], x[1][2] - x[0][2]};
    const V length = sqrt(madd(d[0], d[0], madd(d[1], d[1], d[2] * d[2])));
    const auto defined = length > V(1e-150);
    const V excess = length - field[0], stiffness = field[1];
    const V tension = choose(defined, stiffness * excess / choose(defined, length, V(1.0)), V(0.0));
    for (int c = 0; c < 3; ++c) force[0][c] = tension * d[c];
    return V(0.5) * stiffness * excess * excess;
  }

  // Writes the stretch, which is the current length over the rest length (1 where the rest length is 0). A spring
  // cannot be inverted, so its volume ratio is 1.
  template <class V>
  void stretch(const V (&x)[2][3], const V (&field)[fields], V& largest, V& volume) const {
    using std::sqrt;
    const V d[3] = {x[1][0] - x[0][0], x[1][1] - x[0][1], x[1][2] - x[0][2]};
    const auto has_length = field[0] > V(0.0);
    const V length = sqrt(madd(d[0], d[0], madd(d[1], d[1], d[2] * d[2])));
    largest = choose(has_length, length / choose(has_length, field[0], V(1.0)), V(1.0));
    volume = V(1.0);
  }

  // Writes d^2 E / dx^2 of corner 1 (3 x 3, packed), or the nearest positive semi-definite matrix: k ((1 - r/l)(1 - n
  // n^T) + n n^T). [N/m]
  template <class V>
  void stiffness(const V (&x)[2][3], const V (&field)[fields], bool project, V (&out)[6]) const {
    using std::max;
    using std::sqrt;
    const V d[3] = {x[1][0] - x[0][0], x[1][1] - x[0][1], x[1][2] - x[0][2]};
    const V length = max(sqrt(madd(d[0], d[0], madd(d[1], d[1], d[2] * d[2]))), V(1e-8) * field[0]);
    V across = V(1.0) - field[0] / choose(length > V(0.0), length, V(1.0));
    if (project) across = max(across, V(0.0));
    const V squared = choose(length > V(0.0), length * length, V(1.0));
    for (int i = 0, at = 0; i < 3; ++i) {
      for (int j = 0; j <= i; ++j, ++at)
        out[at] = field[1] * madd(V(1.0) - across, d[i] * d[j] / squared, i == j ? across : V(0.0));
    }
  }

  // Writes a third of the trace of the projected stiffness matrix: k (1 + 2 (1 - r/l)) / 3 [N/m]. The bound `axial`
  // (element_kernels.h) does not apply: in a net of springs, whose directions differ from one to the next, no spring
  // needs more along its own direction.
  template <class V>
  void scalar_stiffness(const V (&x)[2][3], const V (&field)[fields], const V&, V (&out)[1]) const {
    using std::max;
    using std::sqrt;
    const V d[3] = {x[1][0] - x[0][0], x[1][1] - x[0][1], x[1][2] - x[0][2]};
    const V length = max(sqrt(madd(d[0], d[0], madd(d[1], d[1], d[2] * d[2]))), V(1e-8) * field[0]);
    const V across = max(V(1.0) - field[0] / choose(length > V(0.0), length, V(1.0)), V(0.0));
    out[0] = V(1.0 / 3) * field[1] * madd(V(2.0), across, V(1.0));
  }
};

}  // namespace supple
