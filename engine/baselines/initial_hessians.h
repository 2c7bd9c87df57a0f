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
  void begin(const Model&, const StepInputs&, OpenWorkspace&) override { scale_ = 0; }
  void accepted(const Model& model, const StepInputs& inputs, OpenWorkspace& workspace) override;
  void apply(const Model& model, const StepInputs& inputs, OpenWorkspace& workspace, Positions& r,
             Positions& z) override;

 private:
  double scale_ = 0;  // [m/N]; 0: no pair yet
};

// Describes a Hessian that is factored: of which elements it is the sum, when it is made again, and how it turns with
// the body in between.
struct HessianSource {
  enum class Elements {
    at_rest,      // the projected Hessians of the elements in the rest pose, without contacts
    turned_rest,  // the same, each turned by its element's rotation at the step's start, with contacts
    in_pose,      // the projected Hessians of the elements at the first iterate, with contacts
  } elements;
  int searches;  // number of searches from one factorisation to the next; 0: it is made once
  // How the matrix turns in between: at each vertex, by the mean rotation of the elements around it since the matrix
  // was made.
  enum class Turning { none, to_first_iterate, to_start } turning;
};

// The Hessian of the rest pose.
inline constexpr HessianSource rest_hessian_source = {HessianSource::Elements::at_rest, 0,
                                                      HessianSource::Turning::none};
// The Hessian of the rest pose, turned with the body: z = R H^-1 R^T r (Mueller, Dorsey, McMillan, Jagnow, Cutler 2002,
// "Stable real-time deformations").
inline constexpr HessianSource warped_hessian_source = {HessianSource::Elements::at_rest, 0,
                                                        HessianSource::Turning::to_first_iterate};
// The Hessian at the first iterate of each search.
inline constexpr HessianSource frame_hessian_source = {HessianSource::Elements::in_pose, 1,
                                                       HessianSource::Turning::none};
// Sum R_e K_e R_e^T of linear corotated elements, made again in every other search and turned in between (Hecht, Lee,
// Shewchuk, O'Brien 2012, "Updated sparse Cholesky factors for corotational elastodynamics", with all of the mesh
// updated).
inline constexpr HessianSource hecht_hessian_source = {HessianSource::Elements::turned_rest, 2,
                                                       HessianSource::Turning::to_start};

// Applies the inverse of M/h^2 + the Hessian that a source describes, by Cholesky.
class HessianInverse final : public InitialInverse {
 public:
  HessianInverse(const Model& model, const HessianSource& source);
  void begin(const Model& model, const StepInputs& inputs, OpenWorkspace& workspace) override;
  void apply(const Model& model, const StepInputs& inputs, OpenWorkspace& workspace, Positions& r,
             Positions& z) override;

 private:
  void renew(const Model& model, OpenWorkspace& workspace);
  void turn_elements(const Model& model, const Positions& x);

  HessianSource source_;
  ElementMatrices rest_, turned_;  // empty unless the source has turned_rest
  HessianMatrix hessian_;
  ChangingFactor factor_;
  std::vector<Mat3> made_, now_, warp_;  // rotations of the free vertices; empty unless the matrix turns
  long searches_ = 0;
};

// Applies the inverse of the Hessian at the first iterate of each search by conjugate gradients with an incomplete
// Cholesky factor of the rest pose's Hessian or of M/h^2 + L.
class FrameCgInverse final : public InitialInverse {
 public:
  FrameCgInverse(const Model& model, Preconditioner preconditioner, int iterations);
  void begin(const Model& model, const StepInputs& inputs, OpenWorkspace& workspace) override;
  void apply(const Model& model, const StepInputs& inputs, OpenWorkspace& workspace, Positions& r,
             Positions& z) override;

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
  void apply(const Model& model, const StepInputs& inputs, OpenWorkspace& workspace, Positions& r,
             Positions& z) override;

 private:
  int iterations_;
  SparseMatrix matrix_;
  Eigen::VectorXd inverse_diagonal_;
  CgScratch scratch_;
  Eigen::VectorXd right_, solution_;
};

}  // namespace supple
