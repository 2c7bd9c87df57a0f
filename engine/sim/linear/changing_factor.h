// Computes a sparse Cholesky factor again for each matrix of one pattern, in double precision and for one right-hand
// side at a time: for Newton's method and others whose matrix changes. It uses fronts of our own (multifrontal.h), like
// CholeskyFactor, which serves three right-hand sides at once and many solves.
#pragma once

#include <cstdint>
#include <memory>

#include <Eigen/SparseCore>

#include "base/aligned.h"
#include "sim/linear/elimination.h"
#include "sim/linear/multifrontal.h"

namespace supple {

class ChangingFactor {
 public:
  // Takes the lower triangle; entries above the diagonal are ignored. The unknowns must already be in an order with
  // little fill.
  void analyze(const Eigen::SparseMatrix<double>& matrix);

  // Factors a matrix with the pattern that was analysed. Returns false when it is not positive definite; the factor
  // then solves nothing until another matrix has one.
  bool factorize(const Eigen::SparseMatrix<double>& matrix);

  // x = A^-1 b; both have as many numbers as the matrix has rows, and may be the same.
  void solve(const double* b, double* x);

  // Counts the numbers of the factor's columns, including the zeros that merging and padding store.
  std::int64_t stored_numbers() const { return static_cast<std::int64_t>(columns_.size()); }

 private:
  std::unique_ptr<Elimination> elimination_;  // where the fronts can go on seeing it when this is moved
  std::unique_ptr<Multifrontal> fronts_;
  std::vector<std::int64_t> first_number_;  // by node, into columns_
  AlignedVector<double> columns_;           // of L, node after node (front_layout.h)
  AlignedVector<double> scratch_;           // padded rows of the largest front
};

}  // namespace supple
