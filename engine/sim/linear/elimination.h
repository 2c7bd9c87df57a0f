// Finds what Gaussian elimination touches in a symmetric matrix, by pattern alone: groups of adjacent columns that
// share one pattern of rows (supernodes), and an order in which their dense fronts can be stacked. The result depends
// on nothing but the pattern, so it is found once for all matrices that have it.
//
// The method follows Duff, Reid 1983, "The multifrontal solution of indefinite sparse symmetric linear equations"; Liu
// 1992, "The multifrontal method for sparse matrix solution: theory and practice".
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/SparseCore>

#include "sim/linear/front_layout.h"

namespace supple {

// Describes the columns from first to last of the factor, which are dense. Their elimination changes nothing but the
// `row_count` rows below them, which are ascending.
struct Supernode {
  int first, last;
  std::int64_t first_row;  // into Elimination::rows
  int row_count;
  int parent;  // the supernode that holds the first of the rows; -1: none
  int level;   // 0 without a parent, otherwise one more than the parent's

  int width() const { return last - first + 1; }
  FrontShape front() const { return {width(), row_count}; }
};

struct Elimination {
  int size = 0;
  std::vector<Supernode> nodes;  // by columns
  std::vector<std::int32_t> rows;
  std::vector<std::int32_t> order;  // of the nodes: children right before their parent, last child last (a postorder)
  std::int64_t most_column_numbers = 0;    // of the largest front
  std::int64_t deepest_stack[2] = {0, 0};  // most numbers of update matrices that wait at once, by even and odd level

  // Counts the multiplications and additions that the elimination takes.
  double operations() const;

  // Returns the elimination of a matrix by the pattern of its lower triangle, with the unknowns in their order; ignores
  // entries above the diagonal.
  static Elimination of(const Eigen::SparseMatrix<double>& matrix);
};

}  // namespace supple
