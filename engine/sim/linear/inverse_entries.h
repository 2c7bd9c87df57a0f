// Computes entries of A^-1 = L^-T L^-1 among a few unknowns: products of columns of L^-1, each of which is nonzero only
// on its unknown's path to the root of the elimination tree (Davis 2006, "Direct methods for sparse linear systems",
// section 3.2). Two paths are the same from where they meet, so that a product needs only the common ends of two
// columns. Columns of neighbours, which share most of their paths, are computed together, so that L is read once for
// many. Unknowns in different trees of the elimination forest, such as those of different bodies, have the entry 0,
// which is neither computed nor stored. The result depends on the factor alone: not on what was asked for before, nor
// on the number of threads.
#pragma once

#include <algorithm>
#include <vector>

#include "base/aligned.h"
#include "base/threads.h"
#include "sim/linear/cholesky.h"

namespace supple {

class InverseEntries {
 public:
  // Says where the entries of an unknown are kept.
  struct Place {
    std::int32_t tree = 0;
    std::int32_t slot = -1;  // in the tree; -1: not known
  };

  // Ensures that all entries among these unknowns are known. The factor must stay the same until clear(). Allocates
  // for unknowns that are new. threads: null for the calling one alone.
  void learn(const CholeskyFactor& factor, const std::vector<std::int32_t>& unknowns, Threads* threads);

  // Returns the place of an unknown that was learned, which stays until clear().
  Place place(std::int32_t unknown) const { return place_of_[unknown]; }
  // These return the entry of A^-1 for two unknowns that were learned in one call.
  float entry(Place a, Place b) const {
    if (a.tree != b.tree) return 0;
    const auto [low, high] = std::minmax(a.slot, b.slot);
    return trees_[a.tree].products[first_product(high) + low];
  }
  float entry(std::int32_t a, std::int32_t b) const { return entry(place(a), place(b)); }

  // Returns how many numbers are kept.
  std::int64_t stored_numbers() const { return stored_; }
  void clear() { *this = {}; }

 private:
  struct Column {
    std::int32_t strip;            // strip of the column's unknown
    std::int32_t size;             // numbers from the strip's first unknown to the root's last one
    AlignedVector<float> numbers;  // the numbers of the column, at the end of whole cache lines
    const float* end() const { return numbers.data() + numbers.size(); }
  };
  struct Tree {
    std::vector<Column> columns;             // by slot
    std::vector<float> products;             // by slot and earlier slot or itself; NaN: not known
    std::vector<std::int32_t> slots, asked;  // slots of the last calls, ascending: products of `slots` are known
  };
  static std::size_t first_product(std::int32_t slot) { return std::size_t(slot) * (slot + 1) / 2; }
  void prepare(const CholeskyFactor& factor);
  void learn_columns(const CholeskyFactor& factor, Threads* threads);
  template <class T>
  void learn_together(const CholeskyFactor& factor, int first, int count, void* room);
  void learn_products(const CholeskyFactor& factor, Threads* threads);
  void learn_tile(const CholeskyFactor& factor, Tree& tree, int row, int column) const;

  std::vector<std::int32_t> tree_of_;  // by strip
  std::vector<Place> place_of_;        // by unknown
  std::vector<std::int32_t> to_root_;  // by strip: unknowns on the path from it to the root
  std::vector<Tree> trees_;
  std::int64_t stored_ = 0;
  // Scratch memory
  std::vector<std::int32_t> fresh_;
  std::vector<std::pair<std::int32_t, int>> rows_;  // trees with new products, and their rows of tiles
  std::vector<AlignedVector<double>> rooms_;
};

}  // namespace supple
