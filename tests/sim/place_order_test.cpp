// Tests orders of elimination by places: they are permutations, and their fill is near that of METIS.
#include "sim/linear/place_order.h"

#include <gtest/gtest.h>

#include <numeric>

#include "sim/linear/cholesky.h"
#include "support/sparse_matrices.h"

namespace supple {
namespace place_order_test {

// Returns the pattern of a grid of so many places a side, whose neighbours are those within two steps along an axis or
// one across, and the places.
std::pair<test::Sparse, Positions> sheet(int side) {
  Positions places(side * side, 3);
  std::vector<Eigen::Triplet<double>> entries;
  const auto at = [&](int x, int y) { return x * side + y; };
  for (int x = 0; x < side; ++x) {
    for (int y = 0; y < side; ++y) {
      places.row(at(x, y)) = Eigen::RowVector3d(x, 0.2 * y, 0);
      entries.emplace_back(at(x, y), at(x, y), 20.0);
      for (const auto& [i, j] : {std::pair(1, 0), {0, 1}, {1, 1}, {2, 0}, {0, 2}}) {
        if (x + i < side && y + j < side) entries.emplace_back(at(x + i, y + j), at(x, y), -1.0);
      }
    }
  }
  test::Sparse pattern(side * side, side * side);
  pattern.setFromTriplets(entries.begin(), entries.end());
  return {pattern, places};
}

double operations(const test::Sparse& matrix, const std::vector<std::int32_t>& order) {
  std::vector<std::int32_t> place(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) place[order[i]] = static_cast<std::int32_t>(i);
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index column = 0; column < matrix.cols(); ++column) {
    for (test::Sparse::InnerIterator entry(matrix, column); entry; ++entry)
      entries.emplace_back(std::max(place[entry.row()], place[column]), std::min(place[entry.row()], place[column]),
                           entry.value());
  }
  test::Sparse ordered(matrix.rows(), matrix.cols());
  ordered.setFromTriplets(entries.begin(), entries.end());
  return CholeskyFactor(ordered, Precision::double_precision).operations();
}

void expect_permutation(std::vector<std::int32_t> order, Eigen::Index count) {
  std::sort(order.begin(), order.end());
  std::vector<std::int32_t> all(count);
  std::iota(all.begin(), all.end(), 0);
  EXPECT_EQ(order, all);
}

TEST(PlaceOrder, NamesEachUnknownOnce) {
  for (const int side : {0, 1, 4, 5, 30}) {
    const auto [pattern, places] = sheet(side);
    expect_permutation(place_order(pattern, places), pattern.cols());
    expect_permutation(place_order(pattern, Positions::Zero(places.rows(), 3)), pattern.cols());
    test::Sparse apart(pattern.rows(), pattern.cols());
    apart.setIdentity();
    expect_permutation(place_order(apart, places), pattern.cols());
  }
}

TEST(PlaceOrder, FillsInLittleMoreThanMetis) {
  const auto [pattern, places] = sheet(60);
  std::vector<std::pair<std::int32_t, std::int32_t>> edges;
  for (Eigen::Index column = 0; column < pattern.cols(); ++column) {
    for (test::Sparse::InnerIterator entry(pattern, column); entry; ++entry) {
      if (entry.row() != column) edges.emplace_back(entry.row(), column);
    }
  }
  const double by_pattern = operations(pattern, fill_reducing_order(static_cast<int>(pattern.cols()), edges));
  EXPECT_LT(operations(pattern, place_order(pattern, places)), 1.5 * by_pattern);
  std::vector<std::int32_t> none(pattern.cols());
  std::iota(none.begin(), none.end(), 0);
  EXPECT_GT(operations(pattern, none), 3 * by_pattern);
}

}  // namespace place_order_test
}  // namespace supple
