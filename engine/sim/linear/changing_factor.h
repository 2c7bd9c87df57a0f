// Computes a sparse Cholesky factor anew for each of several matrices that have one pattern, and solves for one
// right-hand side at a time. It serves matrices that couple coordinates and change. It uses fronts of our own
// (multifrontal.h), like CholeskyFactor, which serves three right-hand sides at once.
#pragma once

#include <cstdint>
#include <memory>

#include <Eigen/SparseCore>

#include "base/aligned.h"
#include "sim/linear/cholesky.h"
#include "sim/linear/multifrontal.h"

namespace supple {

class ChangingFactor {
 public:
  // The precision is that of the solves; factors are always computed in double precision.
  explicit ChangingFactor(Precision precision = Precision::double_precision) : precision_(precision) {}

  // Analyses the pattern of a matrix's lower triangle; entries above the diagonal are ignored. The unknowns must
  // already be in an order with little fill.
  void analyze(const Eigen::SparseMatrix<double>& matrix);

  // Factors a matrix with the pattern that was analysed. Returns false when it is not positive definite; the factor
  // then solves nothing until another matrix has been factored.
  bool factorize(const Eigen::SparseMatrix<double>& matrix);

  // Computes x = A^-1 b. x and b have as many numbers as the matrix has rows, and may be the same.
  void solve(const double* b, double* x);

  // Counts the numbers of the factor's columns, including the zeros that merging and padding store.
  std::int64_t stored_numbers() const { return static_cast<std::int64_t>(single_.size() + double_.size()); }
  Precision precision() const { return precision_; }
  // Counts the multiplications and additions of one factorisation.
  double operations() const;

 private:
  template <class T>
  void solve_in_place(const AlignedVector<T>& columns, T* x, T* scratch) const;

  Precision precision_;
  std::unique_ptr<Elimination> elimination_;  // on the heap, so that fronts_ still finds it when this object is moved
  std::unique_ptr<Multifrontal> fronts_;
  std::vector<std::int64_t> first_number_;  // by node, into the columns
  // Columns of L, node after node (front_layout.h), in the precision of the solves.
  AlignedVector<float> single_;
  AlignedVector<double> double_;
  AlignedVector<double> front_;    // columns of one front; only in single precision
  AlignedVector<float> x_;         // the unknowns in single precision
  AlignedVector<float> narrow_;    // padded rows of the largest front
  AlignedVector<double> scratch_;  // the same in double precision
};

}  // namespace supple
