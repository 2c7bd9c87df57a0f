// Computes entries of A^-1 = L^-T L^-1 among a few unknowns: products of columns of L^-1, each of which is nonzero only
// on its unknown's path to the root of the elimination tree (Davis 2006, "Direct methods for sparse linear systems",
// section 3.2). Two paths are the same from where they meet, so that a product needs only the common ends of two
// columns. The result depends on the factor alone, not on what was asked for before.
#pragma once

#include <vector>

#include "base/aligned.h"
#include "sim/linear/cholesky.h"

namespace supple {

class InverseEntries {
 public:
  // Ensures that the columns of these unknowns are known. The factor must stay the same until clear().
  void learn(const CholeskyFactor& factor, const std::vector<std::int32_t>& unknowns);

  // Returns the entry of A^-1 for two unknowns whose columns are known.
  float entry(const CholeskyFactor& factor, std::int32_t a, std::int32_t b);

  // Returns how many numbers are kept.
  std::int64_t stored_numbers() const { return stored_ + static_cast<std::int64_t>(products_.size()); }
  void clear() { *this = {}; }

 private:
  void prepare(const CholeskyFactor& factor);
  template <class T>
  void learn_four(const CholeskyFactor& factor, const std::int32_t* unknowns, int count);
  float product(const CholeskyFactor& factor, std::int32_t a, std::int32_t b) const;

  std::vector<std::int32_t> slot_of_;          // by unknown; -1: not known
  std::vector<std::int64_t> to_root_;          // by panel: unknowns on the way from it to the root
  std::vector<AlignedVector<float>> columns_;  // by slot, from its panel's unknowns to the root's
  std::vector<float> products_;                // by slot and earlier slot or itself; NaN: not asked for yet
  std::int64_t stored_ = 0;
  AlignedVector<double> room_;
};

}  // namespace supple
