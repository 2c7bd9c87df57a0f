#include "support/sparse_matrices.h"

#include <algorithm>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

#include "base/types.h"
#include "sim/linear/cholesky.h"

namespace supple::test {

Sparse random_matrix(int size, double links, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> value(-1, 1);
  std::uniform_int_distribution<int> unknown(0, std::max(size - 1, 0));
  std::vector<Eigen::Triplet<double>> entries;
  std::vector<double> diagonal(size, 0.1);
  for (int k = 0; k < links * size; ++k) {
    const int a = unknown(random), b = unknown(random);
    if (a == b) continue;
    const double v = value(random);
    entries.emplace_back(std::max(a, b), std::min(a, b), v);
    diagonal[a] += std::abs(v);
    diagonal[b] += std::abs(v);
  }
  for (int i = 0; i < size; ++i) entries.emplace_back(i, i, diagonal[i]);
  Sparse matrix(size, size);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

Sparse grid_matrix(int n, bool ordered, double mass) {
  const auto at = [&](int x, int y, int z) { return (x * n + y) * n + z; };
  std::vector<std::pair<std::int32_t, std::int32_t>> edges;
  for (int x = 0; x < n; ++x) {
    for (int y = 0; y < n; ++y) {
      for (int z = 0; z < n; ++z) {
        if (x > 0) edges.emplace_back(at(x, y, z), at(x - 1, y, z));
        if (y > 0) edges.emplace_back(at(x, y, z), at(x, y - 1, z));
        if (z > 0) edges.emplace_back(at(x, y, z), at(x, y, z - 1));
      }
    }
  }
  const int size = n * n * n;
  std::vector<std::int32_t> place(size);
  std::iota(place.begin(), place.end(), 0);
  if (ordered) {
    const std::vector<std::int32_t> order = fill_reducing_order(size, edges);
    for (int k = 0; k < size; ++k) place[order[k]] = k;
  }
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < size; ++i) entries.emplace_back(i, i, mass);
  for (const auto& [a, b] : edges) {
    entries.emplace_back(std::max(place[a], place[b]), std::min(place[a], place[b]), -1.0);
    entries.emplace_back(place[a], place[a], 1.0);
    entries.emplace_back(place[b], place[b], 1.0);
  }
  Sparse matrix(size, size);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

Sparse block_matrix(int n, double shift, unsigned seed) {
  const Sparse pattern = grid_matrix(n, true, 0.0);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> value(-1, 1);
  const auto size = static_cast<int>(pattern.rows());
  std::vector<Mat3> diagonal(size, shift * Mat3::Identity());
  std::vector<Eigen::Triplet<double>> entries;
  const auto put = [&](int row, int column, const Mat3& block) {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) entries.emplace_back(3 * row + i, 3 * column + j, block(i, j));
    }
  };
  for (int column = 0; column < size; ++column) {
    for (Sparse::InnerIterator entry(pattern, column); entry; ++entry) {
      const auto row = static_cast<int>(entry.row());
      if (row == column) continue;
      const Mat3 root = Mat3::NullaryExpr([&] { return value(random); });
      const Mat3 block = root * root.transpose();
      diagonal[row] += block;
      diagonal[column] += block;
      put(row, column, -block);
    }
  }
  for (int i = 0; i < size; ++i) put(i, i, diagonal[i]);
  Sparse matrix(3 * size, 3 * size);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

Eigen::MatrixXd dense(const Sparse& matrix) { return Eigen::MatrixXd(matrix).selfadjointView<Eigen::Lower>(); }

Eigen::MatrixXd dense_system(const Model& model) {
  const Eigen::MatrixXd a = dense(model.matrix);
  Eigen::MatrixXd three = Eigen::MatrixXd::Zero(3 * model.free, 3 * model.free);
  for (int i = 0; i < model.free; ++i) {
    for (int j = 0; j < model.free; ++j) three.block<3, 3>(3 * i, 3 * j) = a(i, j) * Mat3::Identity();
  }
  return three;
}

}  // namespace supple::test
