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

namespace supple {

// Columns first to last of the factor, dense; `rows` below them, ascending, are all that their elimination changes.
struct Supernode {
  int first, last;
  std::int64_t first_row;  // into Elimination::rows
  int row_count;
  int parent;  // the supernode that holds the first of the rows; -1: none

  int width() const { return last - first + 1; }
  int front() const { return width() + row_count; }  // rows and columns of its dense front
};

struct Elimination {
  int size = 0;
  std::vector<Supernode> nodes;  // by columns
  std::vector<std::int32_t> rows;
  std::vector<std::int32_t> order;  // of the nodes: children right before their parent, last child last (a postorder)
  std::int64_t largest_front = 0;   // rows
  std::int64_t deepest_stack = 0;   // numbers of update matrices that wait at one time

  // Of the lower triangle's pattern, unknowns eliminated in their order; what stands above the diagonal is not allowed.
  static Elimination of(const Eigen::SparseMatrix<double>& matrix);
};

// Leading dimension of a column-major front or update matrix of so many rows: whole cache lines.
constexpr std::int64_t padded_rows(std::int64_t rows) { return (rows + 7) / 8 * 8; }

}  // namespace supple
