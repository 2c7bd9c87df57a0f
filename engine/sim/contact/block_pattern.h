// Orders the groups of a symmetric matrix for a Cholesky factorisation by blocks, and finds which blocks its factor
// has. The matrix is that of stiff directions (capacitance.h): a group has all directions that act on the same parts of
// a model, and two groups share entries where they share a part. Not here: any number of the matrix (block_factor.h).
#pragma once

#include <array>
#include <vector>

#include "base/types.h"
#include "sim/contact/contact_stencil.h"
#include "sim/model/model.h"

namespace supple {

// Lists the parts that a group acts on, ascending, without repetition, and filled up with -1.
using GroupKey = std::array<std::int32_t, 4>;

// Tells to which part a vertex belongs.
class VertexParts {
 public:
  VertexParts() = default;  // one part
  explicit VertexParts(const std::vector<Part>& parts) { set(parts); }
  void set(const std::vector<Part>& parts);
  int count() const { return static_cast<int>(ends_.size()) + 1; }
  std::int32_t of(std::int32_t vertex) const;
  GroupKey of(const ContactStencil& stencil) const;  // the parts of its free vertices

 private:
  std::vector<std::int32_t> ends_;  // by part but the last one: its last free vertex + 1
};

// Returns an order of elimination with little fill: order[k] is the k-th group to be eliminated. It is that of minimum
// degree (George and Liu 1989, "The evolution of the minimum degree ordering algorithm"), with the groups' sizes as
// weights; of equals, the first group comes first.
std::vector<int> elimination_order(const std::vector<GroupKey>& keys, const std::vector<Eigen::Index>& sizes);

// Lists for each group, in the order of elimination, the later groups with which the factor's column of blocks has a
// block, ascending.
std::vector<std::vector<int>> blocks_below(const std::vector<GroupKey>& keys);

// Counts the multiplications and additions that factor such a matrix, its groups in the order of elimination_order().
double factor_operations(const std::vector<GroupKey>& keys, const std::vector<Eigen::Index>& sizes);

}  // namespace supple
