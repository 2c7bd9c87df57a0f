// Solves with the share that fixed amounts of gas have in the Hessian of g, k u u^T for each, on top of a matrix that
// can be solved with already. The share joins all vertices of a surface, so that no sparse matrix holds it, and without
// it search directions change the volume far too much: air resists a change of volume like an elastic solid of 100 kPa,
// whatever the skin around it. (H + U K U^T)^-1 = H^-1 - Z (K^-1 + U^T Z)^-1 U^T H^-1 with Z = H^-1 U (Sherman,
// Morrison and Woodbury: Nocedal and Wright 2006, "Numerical optimization", appendix A.1).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "sim/air/air_forces.h"

namespace supple {

class GasSolve {
 public:
  // Prepares for solves at x. solve(r, z): sets z = H^-1 r, both n_free x 3; it may overwrite r. Costs one such solve
  // for each fixed amount of gas.
  template <class Solve>
  void begin(const Model& model, const AirForces& air, const Positions& x, const Solve& solve) {
    const int amounts = air.fixed_amounts();
    gradients_.resize(std::size_t(amounts));
    answers_.resize(std::size_t(amounts));
    matrix_.resize(amounts, amounts);
    for (int i = 0; i < amounts; ++i) {
      Positions& u = gradients_[std::size_t(i)];
      const double stiffness = air.rank_one_share(model, i, x, u);
      kept_ = u;
      answers_[std::size_t(i)].resize(u.rows(), 3);
      solve(kept_, answers_[std::size_t(i)]);
      for (int j = 0; j <= i; ++j)
        matrix_(i, j) = matrix_(j, i) = dot(gradients_[std::size_t(j)], answers_[std::size_t(i)]);
      matrix_(i, i) += 1 / stiffness;
    }
  }

  // Turns z = H^-1 r into the solution with the gas.
  void correct(Positions& z) const;

 private:
  static double dot(const Positions& a, const Positions& b) { return (a.array() * b.array()).sum(); }

  std::vector<Positions> gradients_, answers_;  // U and Z, n_free x 3 each
  Positions kept_;
  Eigen::MatrixXd matrix_;
};

}  // namespace supple
