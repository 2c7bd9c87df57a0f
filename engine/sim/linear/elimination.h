// What Gaussian elimination touches in a symmetric matrix, by pattern alone: groups of adjacent columns that share one
// pattern of rows (supernodes), and an order in which their dense fronts can be stacked. Depends on nothing but the
// pattern, so it is found once for all matrices that have it.
//
// Duff, Reid 1983, "The multifrontal solution of indefinite sparse symmetric linear equations"; Liu 1992, "The
// multifrontal method for sparse matrix solution: theory and practice".
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/SparseCore>

#include "sim/linear/front_layout.h"

namespace supple {

// Columns first to last of the factor, dense; `rows` below them, ascending, are all that their elimination changes.
struct Supernode {
  int first, last;
  std::int64_t first_row;  // into Elimination::rows
  int row_count;
  int parent;  // the supernode that holds the first of the rows; -1: none
  int level;   // 0 without a parent, otherwise one more than the parent's

  int width() const { return last - first + 1; }
  FrontShape front() const { return {width(), row_count}; }
};

// How far children are merged into their parents: zeros are stored and worked on, fewer and wider fronts go faster.
struct Merging {
  int always;  // up to so many columns whatever the zeros
  int often;   // up to so many columns while zeros are less than often_zeros of all numbers
  double often_zeros;
  int seldom;
  double seldom_zeros;
  double wide_zeros;  // of wider ones
};

struct Elimination {
  int size = 0;
  std::vector<Supernode> nodes;  // by columns
  std::vector<std::int32_t> rows;
  std::vector<std::int32_t> order;  // of the nodes: children right before their parent, last child last (a postorder)
  std::int64_t most_column_numbers = 0;    // of one front
  std::int64_t deepest_stack[2] = {0, 0};  // numbers of update matrices that wait at one time, of even and odd levels

  // Of the lower triangle's pattern, unknowns eliminated in their order; what stands above the diagonal is ignored.
  static Elimination of(const Eigen::SparseMatrix<double>& matrix, const Merging& merging = for_many_solves);

  // CHOLMOD's thresholds (nrelax, zrelax), which the times of our solves confirm to within noise.
  static constexpr Merging for_many_solves{4, 16, 0.8, 48, 0.1, 0.05};
};

}  // namespace supple
