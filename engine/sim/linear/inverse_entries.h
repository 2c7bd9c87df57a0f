// Computes entries of A^-1 = L^-T L^-1 among a few unknowns: products of columns of L^-1, each of which is nonzero only
// on its unknown's path to the root of the elimination tree (Davis 2006, "Direct methods for sparse linear systems",
// section 3.2). Two paths are the same from where they meet, so that a product needs only the common ends of two
// columns. Columns of neighbours, which share most of their paths, are computed together, so that L is read once for
// many. The result depends on the factor alone: not on what was asked for before, nor on the number of threads.
#pragma once

#include <algorithm>
#include <vector>

#include "base/aligned.h"
#include "base/threads.h"
#include "sim/linear/cholesky.h"

namespace supple {

class InverseEntries {
 public:
  // Ensures that all entries among these unknowns are known. The factor must stay the same until clear(). Allocates
  // for unknowns that are new. threads: null for the calling one alone.
  void learn(const CholeskyFactor& factor, const std::vector<std::int32_t>& unknowns, Threads* threads);

  // Returns the entry of A^-1 for two unknowns that were learned in one call.
  float entry(std::int32_t a, std::int32_t b) const {
    const auto [low, high] = std::minmax(slot_of_[a], slot_of_[b]);
    return products_[first_product(high) + low];
  }

  // Returns how many numbers are kept.
  std::int64_t stored_numbers() const { return stored_ + static_cast<std::int64_t>(products_.size()); }
  void clear() { *this = {}; }

 private:
  struct Column {
    std::int32_t panel;            // panel of the column's unknown
    std::int32_t size;             // numbers from the panel's first unknown to the root's last one
    AlignedVector<float> numbers;  // the numbers of the column, at the end of whole cache lines
    const float* end() const { return numbers.data() + numbers.size(); }
  };
  static std::size_t first_product(std::int32_t slot) { return std::size_t(slot) * (slot + 1) / 2; }
  void prepare(const CholeskyFactor& factor);
  void learn_columns(const CholeskyFactor& factor, Threads* threads);
  template <class T>
  void learn_together(const CholeskyFactor& factor, int first, int count, void* room);
  void learn_products(const CholeskyFactor& factor, Threads* threads);
  void learn_tile(const CholeskyFactor& factor, int row, int column);

  std::vector<std::int32_t> slot_of_;  // by unknown; -1: not known
  std::vector<std::int32_t> to_root_;  // by panel: unknowns on the path from it to the root
  std::vector<Column> columns_;        // by slot
  std::vector<float> products_;        // by slot and earlier slot or itself; NaN: not known
  std::vector<std::int32_t> slots_;    // slots of the last call, ascending: their products are known
  std::int64_t stored_ = 0;
  // Scratch memory
  std::vector<std::int32_t> fresh_, asked_;
  std::vector<AlignedVector<double>> rooms_;
};

}  // namespace supple
