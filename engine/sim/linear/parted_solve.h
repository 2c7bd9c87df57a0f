// Solves A x = b in parts, where an amount is added to b at a few unknowns, and this amount depends on x at a few
// unknowns. These unknowns involve only the columns on their paths to the root of the elimination tree (Gilbert 1994,
// "Predicting structure in sparse matrix computations"; Davis 2006, "Direct methods for sparse linear systems", section
// 3.2). Reading x and adding to b at these unknowns therefore cost as much as this part of the factor, and the whole
// solve is made once.
#pragma once

#include <vector>

#include "base/types.h"
#include "sim/linear/cholesky.h"

namespace supple {

// Lists strips of a factor (front_layout.h), ascending. The list contains the whole path of each of its strips to the
// root.
using FactorPart = std::vector<std::int32_t>;

// Returns the strips on the paths from these unknowns to the root.
FactorPart paths_to_root(const CholeskyFactor& factor, const std::vector<std::int32_t>& unknowns);

// Solves for three right-hand sides at once, as CholeskyFactor::solve does. Parts must belong to the factor with which
// the solve began.
class PartedSolve {
 public:
  // Starts from b (n x 3), or from 0. magnitude: the approximate size of what will be added.
  void begin(const CholeskyFactor& factor, const double* b);
  void begin_from_zero(const CholeskyFactor& factor, double magnitude);

  // Computes x at the unknowns of a part, for b with all additions so far; seen() then returns it.
  void look(const FactorPart& part);
  Vec3 seen(int unknown) const;

  // An addition to b takes three calls: clear_addition(part), add() for unknowns of that part, then pass_on(part).
  void clear_addition(const FactorPart& part);
  void add(int unknown, const Vec3& value);
  void pass_on(const FactorPart& part);

  // Writes x, n x 3.
  void finish(double* x);

 private:
  template <class Work>
  void by_precision(const Work& work);

  const CholeskyFactor* factor_ = nullptr;
  double scale_ = 1;
  // Scratch memory of a front, L^-1 b, and what is looked at or added, both n x 4; all of the factor's precision.
  AlignedVector<double> room_;
};

}  // namespace supple
