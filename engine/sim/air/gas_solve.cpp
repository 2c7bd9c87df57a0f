#include "sim/air/gas_solve.h"

#include <Eigen/Cholesky>

namespace supple {

void GasSolve::correct(Positions& z) const {
  const auto amounts = static_cast<Eigen::Index>(gradients_.size());
  Eigen::VectorXd along(amounts);
  for (Eigen::Index i = 0; i < amounts; ++i) along[i] = dot(gradients_[std::size_t(i)], z);
  const Eigen::VectorXd share = matrix_.ldlt().solve(along);
  if (!share.allFinite()) return;
  for (Eigen::Index i = 0; i < amounts; ++i) z -= share[i] * answers_[std::size_t(i)];
}

}  // namespace supple
