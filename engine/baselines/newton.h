// Implements Newton's method and its relatives, which evaluate the Hessian again in each iteration.
#pragma once

#include "baselines/conjugate_gradients.h"
#include "sim/model/method.h"
#include "sim/solver/hessian_matrix.h"
#include "sim/solver/search_rule.h"

namespace supple {

// Solves by multifrontal Cholesky; the pattern is analysed once.
class NewtonRule final : public SearchRule {
 public:
  // safeguard: projection, on_demand or shift.
  NewtonRule(const Model& model, Safeguard safeguard);
  void begin(const Model&, const StepInputs&, OpenWorkspace&) override { shift_ = 0; }
  double direction(const Model& model, const StepInputs& inputs, OpenWorkspace& workspace) override;

 private:
  void factorize_on_demand(const Model& model, OpenWorkspace& workspace);
  void factorize_shifted();

  Safeguard safeguard_;
  HessianMatrix hessian_;
  ChangingFactor factor_;
  double shift_ = 0;
};

// Solves by conjugate gradients with a Jacobi preconditioner. Without projection they stop where they meet
// indefiniteness.
class NewtonCgRule final : public SearchRule {
 public:
  NewtonCgRule(const Model& model, bool project, int iterations, double tolerance);
  double direction(const Model& model, const StepInputs& inputs, OpenWorkspace& workspace) override;

 private:
  bool project_;
  int iterations_;
  double tolerance_;
  HessianMatrix hessian_;
  CgScratch scratch_;
  Eigen::VectorXd right_, solution_, diagonal_;
};

}  // namespace supple
