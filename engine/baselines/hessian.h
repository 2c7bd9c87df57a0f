// Assembles the Hessian of g over the free vertices, 3n x 3n, which Newton's method and several initial Hessians use;
// and A = M/h^2 + L as a matrix, for methods that solve it in another way. Patterns and places are found once for each
// model.
#pragma once

#include <Eigen/SparseCore>

#include "sim/linear/changing_factor.h"
#include "sim/solver/workspace.h"

namespace supple {

using SparseMatrix = Eigen::SparseMatrix<double>;

// Holds the element matrices, chunk after chunk: for each lane the packed lower triangle (element_kernels.h).
struct ElementMatrices {
  AlignedVector<double> numbers;
  std::vector<std::size_t> first;  // by chunk
};

// Finds the second derivatives of the elements' energies at x, or the nearest positive semi-definite ones [N/m].
void element_matrices(const Model& model, Workspace& workspace, const Positions& x, bool project, ElementMatrices& out);

class HessianMatrix {
 public:
  explicit HessianMatrix(const Model& model);

  // Returns the lower triangle, entries 3 i + c.
  const SparseMatrix& matrix() const { return matrix_; }

  // Sums up w M/h^2, the springs of handles and damping in every case, the element matrices as given, and the contacts
  // in force at x, with friction by the stiffness of its secant. `stick_length`: above this slip, friction has its full
  // strength [m].
  void assemble(const Model& model, const ElementMatrices& elements, const std::vector<Contact>& contacts,
                double stick_length, const Positions& x);

  // Assembles d^2 g at workspace.current with the contacts found there; with `project` each element's Hessian is
  // projected first.
  void assemble(const Model& model, Workspace& workspace, bool project);

  // result = H v, both of 3 n_free numbers.
  void multiply(const double* v, double* result) const;

  // Adds an amount to the diagonal [N/m].
  void shift(double amount);

 private:
  double* block(std::int32_t row, std::int32_t column);  // 3 x 3 by columns of stride_[column]

  SparseMatrix matrix_;
  std::vector<std::int32_t> block_begin_, block_row_;  // by block column
  struct Place {
    std::int32_t row, column;  // corners of the element; row >= column in the matrix after `swapped`
    std::int64_t at;           // of the block's first number; -1: a corner is held
    bool swapped;
  };
  std::vector<Place> places_;             // pairs of corners of each lane, in the order of pairs
  std::vector<std::size_t> first_place_;  // by chunk
  ElementMatrices scratch_;
};

// Factors a sum of projected matrices, which is positive definite up to round-off. Where round-off makes it indefinite,
// a shift of that size corrects it. Throws RunError when no such shift is enough.
void factorize_projected(HessianMatrix& hessian, ChangingFactor& factor);

// Returns A over the free vertices, both triangles [N/m].
SparseMatrix system_matrix_of(const Model& model);

}  // namespace supple
