// Computes the numbers of an elimination, front after front: a front takes its columns of the matrix and the update
// matrices of its children, its own columns are eliminated, and its update matrix stays on a stack until its parent
// needs it. Sums have one order, which depends on the matrix's pattern alone.
#pragma once

#include <Eigen/SparseCore>

#include "base/aligned.h"
#include "sim/linear/elimination.h"

namespace supple {

// Inverts the triangles on the diagonals of a front's strips in its columns of L: a solve then multiplies with them.
void invert_triangles(FrontShape front, double* columns);

class Multifrontal {
 public:
  // The elimination must outlive this object.
  explicit Multifrontal(const Elimination& elimination);

  // This function must be called before the first front of each matrix.
  void begin();

  // Writes a node's columns of the factor (front_layout.h); nodes must come in the elimination's order. Only the lower
  // triangle of the matrix is read. Returns the first unknown whose pivot is not positive, or -1.
  int eliminate(const Eigen::SparseMatrix<double>& matrix, int node, double* columns);

 private:
  void assemble(const Eigen::SparseMatrix<double>& matrix, int node, double* columns, double* update);
  void add_update(const Supernode& parent, const Supernode& child, double* columns, double* update);

  const Elimination& elimination_;
  std::vector<std::int32_t> place_;     // padded row of the front by unknown
  std::vector<std::int32_t> target_;    // padded row of the parent's front by row of a child
  std::vector<std::int32_t> in_strip_;  // place in a strip of that front by row of a child
  std::vector<std::int32_t> waiting_;   // nodes whose update matrices wait
  // The two stacks hold the update matrices of even and of odd levels. Those of a node's children are all on the one
  // stack and the node's own on the other, so that its own is summed up in its final place, and each stack is read only
  // from its top.
  AlignedVector<double> stack_[2];
  std::int64_t stacked_[2] = {0, 0};
};

}  // namespace supple
