// Computes the local step of ADMM for one element (Overby, Brown, Li, Narain 2017, "ADMM ⊇ projective dynamics: fast
// simulation of hyperelastic models with dynamic constraints", section 4): with u the scaled multipliers, z = argmin
// psi(z) + k/2 |z - (F + u)|^2, then u += F - z. As psi is isotropic, z has the singular vectors of F + u, and only its
// three stretches remain to be found.
#pragma once

#include "baselines/local_kernels.h"
#include "sim/elements/spring.h"
#include "sim/elements/tetrahedron_scalar_stiffness.h"

namespace supple {

namespace proximal_detail {

// Returns the density at the stretches s.
template <class M, class V>
V stretch_energy(const M& material, const V (&s)[3]) {
  if constexpr (M::needs == Needs::deformation_gradient) {
    Matrix3<V> f, stress;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) f(i, j) = i == j ? s[i] : V(0.0);
    }
    return material.density(f, stress);
  } else if constexpr (M::needs == Needs::stretch) {
    Symmetric3<V> at, slope;
    at.xx = s[0];
    at.yy = s[1];
    at.zz = s[2];
    at.yz = at.xz = at.xy = V(0.0);
    return material.density(at, slope);
  } else {
    V slope[3];
    return material.density(s, slope);
  }
}

// Solves a positive definite 3 x 3 system by Cramer's rule.
template <class V>
void solve(const V (&a)[3][3], const V (&b)[3], V (&x)[3]) {
  const V c00 = a[1][1] * a[2][2] - a[1][2] * a[1][2], c01 = a[0][2] * a[1][2] - a[0][1] * a[2][2];
  const V c02 = a[0][1] * a[1][2] - a[0][2] * a[1][1], c11 = a[0][0] * a[2][2] - a[0][2] * a[0][2];
  const V c12 = a[0][1] * a[0][2] - a[0][0] * a[1][2], c22 = a[0][0] * a[1][1] - a[0][1] * a[0][1];
  const V scale = V(1.0) / madd(a[0][0], c00, madd(a[0][1], c01, a[0][2] * c02));
  x[0] = scale * madd(c00, b[0], madd(c01, b[1], c02 * b[2]));
  x[1] = scale * madd(c01, b[0], madd(c11, b[1], c12 * b[2]));
  x[2] = scale * madd(c02, b[0], madd(c12, b[1], c22 * b[2]));
}

// Minimises psi(s) + k/2 |s - goal|^2 by Newton's method with projected second derivatives, each lane by itself: where
// the energy does not fall, the lane halves its step. It ends when no lane moves by more than 1e-7, or after 20
// evaluations.
template <class M, class V>
void proximal_stretches(const M& material, const V& k, const V (&goal)[3], V (&s)[3]) {
  using std::abs;
  using std::max;
  const V zero(0.0), one(1.0), half(0.5);
  const auto value_at = [&](const V(&at)[3]) {
    V away = zero;
    for (int i = 0; i < 3; ++i) away = madd(at[i] - goal[i], at[i] - goal[i], away);
    return madd(half * k, away, stretch_energy(material, at));
  };
  for (int i = 0; i < 3; ++i) s[i] = goal[i];
  V value = value_at(s), length = one;
  for (int evaluation = 0; evaluation < 20; ++evaluation) {
    StretchDerivatives<V> at = stretch_derivatives(material, s);
    if (stiffness_detail::some_indefinite(at.second)) stiffness_detail::clamp_eigenvalues(at.second);
    V slope[3], move[3], next[3], largest = zero;
    for (int i = 0; i < 3; ++i) {
      slope[i] = zero - madd(k, s[i] - goal[i], at.slope[i]);
      at.second[i][i] = at.second[i][i] + k;
    }
    solve(at.second, slope, move);
    for (int i = 0; i < 3; ++i) {
      next[i] = madd(length, move[i], s[i]);
      largest = max(largest, abs(length * move[i]));
    }
    const V trial = value_at(next);
    const auto falls = trial <= value;
    for (int i = 0; i < 3; ++i) s[i] = choose(falls, next[i], s[i]);
    value = choose(falls, trial, value);
    length = choose(falls, one, half * length);
    if (!some(largest > V(1e-7))) break;
  }
}

// Makes the local step of a spring whose weight is its stiffness; all is divided by that stiffness. z has the direction
// of v = d + u and the length l that minimises (l - rest)^2 + (l - |v|)^2. At the start, the multipliers become the
// tension of d. force: d - z + u with the new u, and at the start that tension.
template <class V>
void spring_step(const V& rest, const V (&d)[3], bool start, V* u, V (&force)[3]) {
  using std::max;
  using std::sqrt;
  V v[3];
  for (int c = 0; c < 3; ++c) v[c] = start ? d[c] : d[c] + u[c];
  const V length = max(sqrt(madd(v[0], v[0], madd(v[1], v[1], v[2] * v[2]))), V(1e-150));
  const V excess = V(1.0) - rest / length;
  for (int c = 0; c < 3; ++c) {
    const V after = start ? excess * v[c] : V(0.5) * excess * v[c];
    force[c] = start ? after : after + after - u[c];
    u[c] = after;
  }
}

}  // namespace proximal_detail

// Makes the local step at x, or with `start` sets the multipliers to what they are at a minimum at x: the stress over
// k. u: the multipliers before, which become those after. force: k V (F - z + u) grad N of corners 1 to 3, with the new
// u [N]: the slope of the energy that the global step minimises. At the start z = F, and this is the slope of V psi. k:
// weight of the element's term in A [Pa].
template <class M, class V>
void tetrahedron_proximal(const M& material, const Fibre* fibre, const V& k, const V (&x)[4][3],
                          const V (&field)[Tetrahedron::fields], bool start, V (&u)[most_multipliers],
                          V (&force)[3][3]) {
  const Matrix3<V> f = deformation_gradient(x, field);
  const V volume = field[9], weight = k * volume;
  Matrix3<V> pull;
  if (start) {
    density_of(material, f, pull);
    for (int i = 0; i < 9; ++i) {
      u[i] = pull.m[i] / k;
      pull.m[i] = volume * pull.m[i];
    }
  } else {
    Matrix3<V> goal;
    for (int i = 0; i < 9; ++i) goal.m[i] = f.m[i] + u[i];
    const Svd3<V> parts = svd(goal);
    V s[3];
    proximal_detail::proximal_stretches(material, k, parts.s, s);
    const Matrix3<V> z = recomposed(parts, s);
    for (int i = 0; i < 9; ++i) {
      const V after = goal.m[i] - z.m[i];
      pull.m[i] = weight * (after + after - u[i]);  // F - z + u after, with F - z = u after - u before
      u[i] = after;
    }
  }
  if (fibre != nullptr) {
    const V kappa = V(fibre->kappa) * volume;
    const V d[3] = {V(fibre->direction[0]), V(fibre->direction[1]), V(fibre->direction[2])};
    V along[3];
    for (int i = 0; i < 3; ++i) along[i] = madd(f(i, 0), d[0], madd(f(i, 1), d[1], f(i, 2) * d[2]));
    V tension[3];
    proximal_detail::spring_step(V(1.0), along, start, u + 9, tension);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) pull(i, j) = madd(kappa * tension[i], d[j], pull(i, j));
    }
  }
  for (int i = 0; i < 3; ++i) {
    for (int c = 0; c < 3; ++c)
      force[c][i] = madd(pull(i, 0), field[3 * c], madd(pull(i, 1), field[3 * c + 1], pull(i, 2) * field[3 * c + 2]));
  }
}

template <class V>
void spring_proximal(const V (&x)[2][3], const V (&field)[SpringElement::fields], bool start, V (&u)[most_multipliers],
                     V (&force)[1][3]) {
  const V d[3] = {x[1][0] - x[0][0], x[1][1] - x[0][1], x[1][2] - x[0][2]};
  proximal_detail::spring_step(field[0], d, start, u, force[0]);
  for (int c = 0; c < 3; ++c) force[0][c] = field[1] * force[0][c];
}

}  // namespace supple
