// Defines the initial Hessians of L-BFGS with which the paper compares M/h^2 + L (Liu et al. 2017, figures 8, 16 and
// 17).
#pragma once

#include <Eigen/IterativeLinearSolvers>

#include "baselines/conjugate_gradients.h"
#include "baselines/system_matrix.h"
#include "sim/model/method.h"
#include "sim/solver/hessian_matrix.h"
#include "sim/solver/lbfgs.h"

namespace supple {

// Applies the inverse of (t.t / s.t) I of the last pair (equation 13 is the scale of the inverse), and of M/h^2 before
// there is a pair.
class IdentityInverse final : public InitialInverse {
 public:
  void begin(const Model&, const StepInputs&, Workspace&) override { scale_ = 0; }
  void accepted(const Model& model, const StepInputs& inputs, Workspace& workspace) override;
  void apply(const Model& model, const StepInputs& inputs, Workspace& workspace, Positions& r, Positions& z) override;

 private:
  double scale_ = 0;  // [m/N]; 0: no pair yet
};

// Applies the inverse of M/h^2 + the Hessian of the rest pose, which is factored once.
class RestInverse : public InitialInverse {
 public:
  explicit RestInverse(const Model& model);
  void apply(const Model& model, const StepInputs& inputs, Workspace& workspace, Positions& r, Positions& z) override;

 private:
  ChangingFactor factor_;
};

// Applies the same inverse, rotated at each vertex by the rotation of the elements around it at the start of a step
// (Mueller, Dorsey, McMillan, Jagnow, Cutler 2002, "Stable real-time deformations"): z = R H^-1 R^T r.
class WarpedInverse final : public RestInverse {
 public:
  using RestInverse::RestInverse;
  void begin(const Model& model, const StepInputs& inputs, Workspace& workspace) override;
  void apply(const Model& model, const StepInputs& inputs, Workspace& workspace, Positions& r, Positions& z) override;

 private:
  std::vector<Mat3> rotation_;  // by free vertex
};

// Applies the inverse of the projected Hessian at the first iterate of each step, by Cholesky.
class FrameInverse final : public InitialInverse {
 public:
  explicit FrameInverse(const Model& model);
  void begin(const Model& model, const StepInputs& inputs, Workspace& workspace) override;
  void apply(const Model& model, const StepInputs& inputs, Workspace& workspace, Positions& r, Positions& z) override;

 private:
  HessianMatrix hessian_;
  ChangingFactor factor_;
};

// Applies the same inverse by conjugate gradients with an incomplete Cholesky factor of the rest pose's Hessian or of
// M/h^2 + L.
class FrameCgInverse final : public InitialInverse {
 public:
  FrameCgInverse(const Model& model, Preconditioner preconditioner, int iterations);
  void begin(const Model& model, const StepInputs& inputs, Workspace& workspace) override;
  void apply(const Model& model, const StepInputs& inputs, Workspace& workspace, Positions& r, Positions& z) override;

 private:
  using Incomplete = Eigen::IncompleteCholesky<double, Eigen::Lower, Eigen::NaturalOrdering<int>>;
  Preconditioner preconditioner_;
  int iterations_;
  HessianMatrix hessian_;
  Incomplete incomplete_;
  CgScratch scratch_;
  Eigen::VectorXd right_, solution_;
};

// Applies the inverse of M/h^2 + L by conjugate gradients with a Jacobi preconditioner.
class SystemCgInverse final : public InitialInverse {
 public:
  SystemCgInverse(const Model& model, int iterations);
  void apply(const Model& model, const StepInputs& inputs, Workspace& workspace, Positions& r, Positions& z) override;

 private:
  int iterations_;
  SparseMatrix matrix_;
  Eigen::VectorXd inverse_diagonal_;
  CgScratch scratch_;
  Eigen::VectorXd right_, solution_;
};

// Applies the inverse of Sum R_e K_e R_e^T of linear corotated elements, which is renewed every other step. In between
// it is rotated at each vertex by the rotation of the elements around it since then (Hecht, Lee, Shewchuk, O'Brien
// 2012, "Updated sparse Cholesky factors for corotational elastodynamics", with all of the mesh updated).
class HechtInverse final : public InitialInverse {
 public:
  explicit HechtInverse(const Model& model);
  void begin(const Model& model, const StepInputs& inputs, Workspace& workspace) override;
  void apply(const Model& model, const StepInputs& inputs, Workspace& workspace, Positions& r, Positions& z) override;

 private:
  ElementMatrices rest_, turned_;
  HessianMatrix hessian_;
  ChangingFactor factor_;
  std::vector<Mat3> factored_, now_, warp_;  // by free vertex
  long steps_ = 0;
};

// Applies the inverse of M/h^2 + L with a spring of 2 k_c at each touching vertex. It is factored again when the set of
// touching vertices changes (the second way of Bouaziz et al. 2014, which section 4.3 of the paper discusses). apply()
// throws RunError where that matrix is not positive definite.
class ContactMatrixInverse final : public InitialInverse {
 public:
  explicit ContactMatrixInverse(const Model& model);
  void begin(const Model&, const StepInputs&, Workspace&) override { factored_.clear(); }
  void apply(const Model& model, const StepInputs& inputs, Workspace& workspace, Positions& r, Positions& z) override;

 private:
  SparseMatrix system_, matrix_;  // lower triangles
  CholeskyFactor factor_;
  SolveScratch scratch_;
  std::vector<double> stiffness_, factored_;  // by free vertex [N/m]
};

}  // namespace supple
