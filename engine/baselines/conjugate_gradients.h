// Implements preconditioned conjugate gradients from zero (Saad 2003, "Iterative methods for sparse linear systems",
// algorithm 9.1).
#pragma once

#include <Eigen/Core>

namespace supple {

struct CgScratch {
  Eigen::VectorXd residual, precond, search, product;
};

// Brings x close to H^-1 b in at most `iterations` iterations, fewer once |r| <= tolerance |b|. When it meets p^T H p
// <= 0, it stops with the present x, or with the preconditioned b when there is no x yet (Gast et al. 2015,
// "Optimization integrator for large time steps", section 4). Returns the number of iterations. multiply(v, result)
// sets the result to H v, and precondition(r, z) sets z to the preconditioned r.
template <class Multiply, class Precondition>
int conjugate_gradients(const Eigen::VectorXd& b, Eigen::VectorXd& x, int iterations, double tolerance,
                        const Multiply& multiply, const Precondition& precondition, CgScratch& s) {
  x.setZero(b.size());
  s.residual = b;
  s.precond.resize(b.size());
  s.product.resize(b.size());
  precondition(s.residual, s.precond);
  s.search = s.precond;
  double rho = s.residual.dot(s.precond);
  const double enough = tolerance * b.norm();
  for (int i = 0; i < iterations; ++i) {
    multiply(s.search, s.product);
    const double curvature = s.search.dot(s.product);
    if (!(curvature > 0)) {
      if (i == 0) x = s.precond;
      return i;
    }
    const double alpha = rho / curvature;
    x += alpha * s.search;
    s.residual -= alpha * s.product;
    if (s.residual.norm() <= enough) return i + 1;
    precondition(s.residual, s.precond);
    const double next = s.residual.dot(s.precond);
    s.search = s.precond + next / rho * s.search;
    rho = next;
  }
  return iterations;
}

}  // namespace supple
