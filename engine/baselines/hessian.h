// Assembles the Hessian of g over the free vertices, 3n x 3n, which Newton's method and several initial Hessians use;
// and A = M/h^2 + L as a matrix, for methods that solve it in another way.
#pragma once

#include <Eigen/SparseCore>

#include "sim/linear/changing_factor.h"
#include "sim/model/elastic_hessian.h"
#include "sim/solver/workspace.h"

namespace supple {

using SparseMatrix = Eigen::SparseMatrix<double>;

class HessianMatrix : public ElasticHessian {
 public:
  using ElasticHessian::ElasticHessian;

  // Sums up what ElasticHessian does, and the contacts in force at x, with friction by the stiffness of its secant.
  // `stick_length`: above this slip, friction has its full strength [m].
  void assemble(const Model& model, const ElementMatrices& elements, const std::vector<Contact>& contacts,
                double stick_length, const Positions& x);

  // Assembles d^2 g at workspace.current with the contacts found there; with `project` each element's Hessian is
  // projected first.
  void assemble(const Model& model, Workspace& workspace, bool project);

 private:
  ElementMatrices scratch_;
};

// Factors a sum of projected matrices, which is positive definite up to round-off. Where round-off makes it indefinite,
// a shift of that size corrects it. Throws RunError when no such shift is enough.
void factorize_projected(HessianMatrix& hessian, ChangingFactor& factor);

// Returns A over the free vertices, both triangles [N/m].
SparseMatrix system_matrix_of(const Model& model);

}  // namespace supple
