// Factors a sparse symmetric positive definite matrix that is solved many times: CHOLMOD orders it, fronts of our own
// compute the numbers (multifrontal.h; the bits depend on the matrix and the instruction set, on no BLAS and no number
// of threads), and loops of our own solve for three right-hand sides at once. No other part of the program uses
// CHOLMOD. An object is not thread-safe: build it on one thread. For a matrix that changes with each solve:
// changing_factor.h.
#pragma once

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include <Eigen/SparseCore>

#include "base/aligned.h"
#include "base/types.h"
#include "sim/linear/elimination.h"
#include "sim/linear/linear_kernels.h"
#include "sim/linear/precision.h"

namespace supple {

// Returns an order of elimination with little fill (nested dissection): order[k] is the k-th unknown to be eliminated.
// edges: pairs of different unknowns below `count` that share a matrix entry, each at least once.
std::vector<std::int32_t> fill_reducing_order(int count,
                                              const std::vector<std::pair<std::int32_t, std::int32_t>>& edges);

// Returns a power of two that brings the largest of some numbers near 1, so that single precision neither overflows nor
// falls into denormals.
double solve_scale(const double* numbers, int count);

class Multifrontal;

class CholeskyFactor {
 public:
  CholeskyFactor() = default;
  CholeskyFactor(const Eigen::SparseMatrix<double>& matrix, Precision precision) { factorize(matrix, precision); }

  // Returns the factor of the block-diagonal matrix whose blocks, in this order, have these factors; no number is
  // computed anew. The factors must have one precision. The result can solve, but must not be renewed.
  static CholeskyFactor block_diagonal(const std::vector<const CholeskyFactor*>& blocks);

  // Factors a lower triangle (compressed, nothing stored above the diagonal) in the order given. For a matrix with the
  // pattern of the last one, only the numbers are computed again. Throws RunError with the number of the column when
  // the matrix is not positive definite; the factor then solves nothing.
  void factorize(const Eigen::SparseMatrix<double>& matrix, Precision precision);

  // Provides memory for factoring anew, so that renew() allocates nothing. It belongs to one factor, which must stay
  // where it is.
  class Room {
   public:
    Room();
    ~Room();

   private:
    friend class CholeskyFactor;
    std::unique_ptr<Multifrontal> fronts_;
    AlignedVector<double> columns_;
    int failed_ = -1;  // the unknown whose pivot was not positive
  };
  // Factors a matrix with the pattern of the last one, in its precision. Returns false where it is not positive
  // definite; the factor then solves nothing.
  bool renew(const Eigen::SparseMatrix<double>& matrix, Room& room);

  int size() const { return size_; }
  std::int64_t stored_numbers() const { return static_cast<std::int64_t>(single_.size() + double_.size()); }

  // Counts the multiplications and additions of one factorisation.
  double operations() const { return operations_; }

  // Computes x = A^-1 b for b and x of `size` x 3 numbers, by rows. Allocates where scratch has less than
  // scratch_numbers().
  void solve(const double* b, double* x, AlignedVector<double>& scratch) const;
  std::size_t scratch_numbers() const;

  // These functions solve a half of the system in place (LinearKernels::Solve), for code that solves in parts
  // (parted_solve.h). T: the type of precision(). strips: null for all. scratch: front_numbers() numbers.
  template <class T>
  void down(const std::vector<std::int32_t>* strips, T* x, T* scratch) const;
  template <class T>
  void up(const std::vector<std::int32_t>* strips, T* x, T* scratch) const;
  // Returns three times the padded rows of the largest front.
  std::size_t front_numbers() const { return 3 * std::size_t(most_rows_); }

  FactorView view() const;
  Precision precision() const { return precision_; }
  std::int32_t strip_of(int unknown) const { return strip_of_[unknown]; }
  // Returns the first unknown of a strip, and how many it has.
  std::int32_t first_column(int strip) const;
  int width(int strip) const;
  // Returns the strip of the first row below a strip, which is the next one on the path to the root of the elimination
  // tree; -1: none.
  std::int32_t parent_of(int strip) const;
  // Returns the first strip that the paths of two strips to the root have in common; -1: none.
  std::int32_t meeting_of(std::int32_t a, std::int32_t b) const;

 private:
  bool has_pattern_of(const Eigen::SparseMatrix<double>& matrix) const;
  void analyze(const Eigen::SparseMatrix<double>& matrix);

  int size_ = 0;
  Precision precision_ = Precision::double_precision;
  double operations_ = 0;
  std::vector<int> outer_, inner_;  // the pattern that was analysed
  Elimination elimination_;
  std::vector<FactorFront> fronts_;     // by supernode
  std::vector<std::int32_t> rows_;      // below the fronts
  std::vector<std::int32_t> front_of_;  // by strip
  std::vector<std::int32_t> strip_of_;  // by unknown
  std::int64_t number_count_ = 0;
  int most_rows_ = 0;  // padded, of the largest front
  AlignedVector<float> single_;
  AlignedVector<double> double_;
};

}  // namespace supple
