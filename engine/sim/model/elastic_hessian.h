// Assembles the Hessian of a step's objective over the free vertices without contacts, 3n x 3n: pattern and places are
// found once for each model. Not here: contacts (solver/hessian_matrix.h), and when it is made (solver/matrix_rule.h).
#pragma once

#include <Eigen/SparseCore>

#include "base/threads.h"
#include "sim/model/model.h"

namespace supple {

// Holds the element matrices, chunk after chunk: for each lane the packed lower triangle (element_kernels.h).
struct ElementMatrices {
  AlignedVector<double> numbers;
  std::vector<std::size_t> first;  // by chunk
};

// Finds the second derivatives of the elements' energies at x or, where `project`, positive semi-definite ones near
// them [N/m]. threads: may be null.
void element_matrices(const Model& model, Threads* threads, const Positions& x, bool project, ElementMatrices& out);

class ElasticHessian {
 public:
  explicit ElasticHessian(const Model& model);

  // Returns the lower triangle, whose row 3 i + c belongs to coordinate c of vertex i.
  const Eigen::SparseMatrix<double>& matrix() const { return matrix_; }

  // Sums up w M/h^2, damping, and e theta^2 times the springs of handles, bending, seams and the element matrices as
  // given.
  void assemble(const Model& model, const ElementMatrices& elements);

  // Adds to the 3 x 3 block of two free vertices, which an element, a bend, a seam or a triangle of the surface must
  // join; row >= column.
  void add(std::int32_t row, std::int32_t column, const Mat3& part);

  // Computes result = H v, both of 3 n_free numbers.
  void multiply(const double* v, double* result) const;

  // Adds an amount to the diagonal [N/m].
  void shift(double amount);

 private:
  // Makes the matrix of so many free vertices, whose blocks are known, without its numbers.
  void make_pattern(int vertices);
  // Finds where the blocks of each element lie in the matrix.
  void find_places(const Model& model);
  // Returns the first number of a 3 x 3 block, whose columns lie one column of the matrix apart.
  double* block(std::int32_t row, std::int32_t column);

  Eigen::SparseMatrix<double> matrix_;
  std::vector<std::int32_t> block_begin_, block_row_;  // by block column
  struct Place {
    std::int32_t row, column;  // corners of the element, exchanged where `swapped`: then row >= column in the matrix
    std::int64_t at;           // place of the block's first number; -1: a corner is held
    bool swapped;
  };
  std::vector<Place> places_;             // by lane and pair of corners
  std::vector<std::size_t> first_place_;  // by chunk
};

}  // namespace supple
