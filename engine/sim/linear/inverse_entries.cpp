#include "sim/linear/inverse_entries.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/linear/parted_solve.h"

namespace supple {
namespace {

constexpr std::size_t line = 64 / sizeof(float);  // numbers of a cache line

}  // namespace

void InverseEntries::prepare(const CholeskyFactor& factor) {
  if (!to_root_.empty()) return;
  const int strips = factor.view().strip_count;
  place_of_.assign(factor.size(), {});
  to_root_.resize(strips);
  tree_of_.resize(strips);
  std::int32_t trees = 0;
  for (int strip = strips - 1; strip >= 0; --strip) {
    const std::int32_t parent = factor.parent_of(strip);
    to_root_[strip] = factor.width(strip) + (parent >= 0 ? to_root_[parent] : 0);
    tree_of_[strip] = parent >= 0 ? tree_of_[parent] : trees++;
  }
  trees_.resize(trees);
}

void InverseEntries::learn(const CholeskyFactor& factor, const std::vector<std::int32_t>& unknowns, Threads* threads) {
  prepare(factor);
  fresh_.clear();
  for (const std::int32_t unknown : unknowns) {
    if (place_of_[unknown].slot < 0) fresh_.push_back(unknown);
  }
  std::sort(fresh_.begin(), fresh_.end());
  fresh_.erase(std::unique(fresh_.begin(), fresh_.end()), fresh_.end());
  learn_columns(factor, threads);
  for (Tree& tree : trees_) tree.asked.clear();
  for (const std::int32_t unknown : unknowns) trees_[place_of_[unknown].tree].asked.push_back(place_of_[unknown].slot);
  rows_.clear();
  for (std::size_t t = 0; t < trees_.size(); ++t) {
    Tree& tree = trees_[t];
    std::sort(tree.asked.begin(), tree.asked.end());
    tree.asked.erase(std::unique(tree.asked.begin(), tree.asked.end()), tree.asked.end());
    if (std::includes(tree.slots.begin(), tree.slots.end(), tree.asked.begin(), tree.asked.end())) continue;
    tree.slots.swap(tree.asked);
    const int tiles = (static_cast<int>(tree.slots.size()) + product_tile - 1) / product_tile;
    for (int row = 0; row < tiles; ++row) rows_.emplace_back(static_cast<std::int32_t>(t), row);
  }
  learn_products(factor, threads);
}

void InverseEntries::learn_columns(const CholeskyFactor& factor, Threads* threads) {
  if (fresh_.empty()) return;
  for (const std::int32_t unknown : fresh_) {
    const std::int32_t strip = factor.strip_of(unknown), tree = tree_of_[strip];
    std::vector<Column>& columns = trees_[tree].columns;
    place_of_[unknown] = {tree, static_cast<std::int32_t>(columns.size())};
    columns.push_back({strip, to_root_[strip], {}});
    stored_ += to_root_[strip] + std::ssize(columns);
  }
  for (Tree& tree : trees_) {
    tree.products.resize(first_product(static_cast<std::int32_t>(tree.columns.size())),
                         std::numeric_limits<float>::quiet_NaN());
  }
  const bool single = factor.precision() == Precision::single_precision;
  const int batches = static_cast<int>((fresh_.size() + columns_together - 1) / columns_together);
  const int at_once = std::min(batches, threads != nullptr ? threads->count() : 1);
  rooms_.resize(at_once);
  for (AlignedVector<double>& room : rooms_)
    room.resize(columns_together * std::size_t(factor.size()) / (single ? 2 : 1));
  for (int batch = 0; batch < batches; batch += at_once) {
    const auto learn_batch = [&](int k) {
      const int first = (batch + k) * columns_together;
      const int count = std::min(columns_together, static_cast<int>(fresh_.size()) - first);
      single ? learn_together<float>(factor, first, count, rooms_[k].data())
             : learn_together<double>(factor, first, count, rooms_[k].data());
    };
    const int now = std::min(at_once, batches - batch);
    now > 1 ? threads->run(now, learn_batch) : learn_batch(0);
  }
}

template <class T>
void InverseEntries::learn_together(const CholeskyFactor& factor, int first, int count, void* room) {
  const FactorView view = factor.view();
  T* x = static_cast<T*>(room);
  const std::int32_t* unknowns = fresh_.data() + first;
  const FactorPart part = paths_to_root(factor, {unknowns, unknowns + count});
  for (const std::int32_t strip : part)
    std::fill_n(x + columns_together * long(factor.first_column(strip)), columns_together * factor.width(strip), T(0));
  for (int k = 0; k < count; ++k) x[columns_together * long(unknowns[k]) + k] = 1;
  const int strips = static_cast<int>(part.size());
  if constexpr (sizeof(T) == sizeof(float)) {
    linear_kernels().down_many_float(view, part.data(), strips, x);
  } else {
    linear_kernels().down_many_double(view, part.data(), strips, x);
  }
  for (int k = 0; k < count; ++k) {
    const Place place = place_of_[unknowns[k]];
    Column& column = trees_[place.tree].columns[place.slot];
    column.numbers.resize((std::size_t(column.size) + line - 1) / line * line);
    float* to = column.numbers.data() + column.numbers.size() - column.size;
    for (std::int32_t strip = column.strip; strip >= 0; strip = factor.parent_of(strip)) {
      const T* from = x + columns_together * long(factor.first_column(strip)) + k;
      for (int i = 0; i < factor.width(strip); ++i) *to++ = static_cast<float>(from[columns_together * i]);
    }
  }
}

void InverseEntries::learn_products(const CholeskyFactor& factor, Threads* threads) {
  long tiles = 0;
  for (const auto& [tree, row] : rows_) tiles += 2 * row + 1;
  run_chunks(threads, static_cast<int>(rows_.size()), tiles * 100, [&](int k) {
    const auto [tree, row] = rows_[k];
    for (int column = 0; column <= row; ++column) learn_tile(factor, trees_[tree], row, column);
  });
}

// Computes the products between the slots of two tiles, unless they are known.
void InverseEntries::learn_tile(const CholeskyFactor& factor, Tree& tree, int row, int column) const {
  const auto slot = [&](int tile, int i) -> const std::int32_t& {
    return tree.slots[std::min<std::size_t>(std::size_t(tile) * product_tile + i, tree.slots.size() - 1)];
  };
  bool known = true;
  for (int i = 0; i < product_tile; ++i) {
    for (int j = 0; j < product_tile; ++j) {
      const auto [low, high] = std::minmax(slot(row, i), slot(column, j));
      known = known && !std::isnan(tree.products[first_product(high) + low]);
    }
  }
  if (known) return;
  const float *a[product_tile], *b[product_tile];
  std::int32_t count[product_tile * product_tile];
  float products[product_tile * product_tile];
  for (int i = 0; i < product_tile; ++i) {
    const Column& own = tree.columns[slot(row, i)];
    a[i] = own.end();
    b[i] = tree.columns[slot(column, i)].end();
    for (int j = 0; j < product_tile; ++j) {
      const std::int32_t meeting = factor.meeting_of(own.strip, tree.columns[slot(column, j)].strip);
      count[i * product_tile + j] = meeting >= 0 ? to_root_[meeting] : 0;
    }
  }
  linear_kernels().end_products(a, b, count, products);
  for (int i = 0; i < product_tile; ++i) {
    for (int j = 0; j < product_tile; ++j) {
      const auto [low, high] = std::minmax(slot(row, i), slot(column, j));
      tree.products[first_product(high) + low] = products[i * product_tile + j];
    }
  }
}

}  // namespace supple
