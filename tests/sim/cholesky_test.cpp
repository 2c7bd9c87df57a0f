#include "sim/linear/cholesky.h"
#include "base/variants.h"
#include "sim/linear/changing_factor.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <chrono>
#include <csignal>
#include <numeric>
#include <random>
#include <thread>

#include "base/error.h"

namespace supple {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

// Makes a random lower triangle with about `links` entries a column, which its diagonal makes positive definite.
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

// Makes the 7-point Laplacian of a grid plus a little mass, either in an order with little fill or in the grid's own
// order.
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

Eigen::MatrixXd dense(const Sparse& matrix) { return Eigen::MatrixXd(matrix).selfadjointView<Eigen::Lower>(); }

Eigen::MatrixX3d solve(const CholeskyFactor& factor, const Eigen::MatrixX3d& b) {
  const int size = factor.size();
  std::vector<double> right(3 * size), x(3 * size);
  AlignedVector<double> scratch(4 * size + 8);
  for (int i = 0; i < size; ++i) {
    for (int c = 0; c < 3; ++c) right[3 * i + c] = b(i, c);
  }
  factor.solve(right.data(), x.data(), scratch.data());
  Eigen::MatrixX3d out(size, 3);
  for (int i = 0; i < size; ++i) {
    for (int c = 0; c < 3; ++c) out(i, c) = x[3 * i + c];
  }
  return out;
}

// Computes || A x - b || / || b ||.
double residual(const Sparse& matrix, const CholeskyFactor& factor) {
  const Eigen::MatrixX3d b = Eigen::MatrixX3d::Random(matrix.rows(), 3);
  const Eigen::MatrixX3d x = solve(factor, b);
  return (matrix.selfadjointView<Eigen::Lower>() * x - b).norm() / b.norm();
}

// Captures all bits of a factor by what it does to the columns of the identity.
Eigen::MatrixXd inverse(const CholeskyFactor& factor) {
  const int size = factor.size();
  Eigen::MatrixXd out(size, size);
  for (int i = 0; i < size; ++i) {
    Eigen::MatrixX3d unit = Eigen::MatrixX3d::Zero(size, 3);
    unit(i, 0) = 1;
    out.col(i) = solve(factor, unit).col(0);
  }
  return out;
}

volatile std::sig_atomic_t terminations = 0;

TEST(FillReducingOrder, IsTheSameWhenTheProgramIsAskedToEndMeanwhile) {
  std::vector<std::pair<std::int32_t, std::int32_t>> edges;
  constexpr int n = 4000;
  std::mt19937 random(5);
  for (int i = 1; i < n; ++i) {
    edges.emplace_back(i, i - 1);
    if (i > 60) edges.emplace_back(i, i - 60 + static_cast<int>(random() % 3));
  }
  const std::vector<std::int32_t> order = fill_reducing_order(n, edges);
  const auto count = [](int) { terminations = terminations + 1; };
  const auto before = std::signal(SIGTERM, count);
  const pthread_t caller = pthread_self();
  int sent = 0;
  for (int delay = 0; delay < 40; ++delay) {
    std::thread sender([&] {
      std::this_thread::sleep_for(std::chrono::microseconds(150 * delay));
      sent += pthread_kill(caller, SIGTERM) == 0;
    });
    EXPECT_EQ(fill_reducing_order(n, edges), order) << delay;
    sender.join();
  }
  EXPECT_EQ(sent, 40);
  EXPECT_EQ(terminations, sent);
  std::signal(SIGTERM, before);
}

TEST(Elimination, FindsThePatternOfTheDenseFactor) {
  for (const unsigned seed : {1u, 2u, 3u, 4u}) {
    const Sparse matrix = random_matrix(70, 0.4 * seed, seed);
    const Elimination elimination = Elimination::of(matrix);
    Eigen::MatrixXd stored = Eigen::MatrixXd::Zero(70, 70);
    int next = 0;
    for (const Supernode& node : elimination.nodes) {
      EXPECT_EQ(node.first, next);
      next = node.last + 1;
      for (int j = node.first; j <= node.last; ++j) {
        stored.block(j, j, next - j, 1).setOnes();
        for (int i = 0; i < node.row_count; ++i) stored(elimination.rows[node.first_row + i], j) = 1;
      }
      if (node.parent >= 0) {
        EXPECT_GE(elimination.rows[node.first_row], elimination.nodes[node.parent].first);
        EXPECT_LE(elimination.rows[node.first_row], elimination.nodes[node.parent].last);
      }
    }
    EXPECT_EQ(next, 70);
    const Eigen::MatrixXd full = dense(matrix);
    const Eigen::MatrixXd factor = full.llt().matrixL();
    for (int j = 0; j < 70; ++j) {
      for (int i = j; i < 70; ++i) {
        EXPECT_TRUE(stored(i, j) == 1 || std::abs(factor(i, j)) < 1e-14) << i << ", " << j;
      }
    }
  }
}

TEST(Elimination, ComesToChildrenBeforeTheirParents) {
  const Elimination elimination = Elimination::of(random_matrix(200, 0.7, 7));
  std::vector<bool> done(elimination.nodes.size(), false);
  for (const std::int32_t s : elimination.order) {
    for (std::size_t child = 0; child < elimination.nodes.size(); ++child) {
      EXPECT_TRUE(elimination.nodes[child].parent != s || done[child]);
    }
    EXPECT_FALSE(done[s]);
    done[s] = true;
  }
  EXPECT_EQ(elimination.order.size(), elimination.nodes.size());
}

TEST(CholeskyFactor, SolvesWhateverThePattern) {
  for (const double links : {0.0, 0.3, 0.6, 1.0, 3.0, 20.0}) {  // from diagonal over forests to nearly dense
    for (const int size : {1, 2, 3, 7, 8, 9, 40, 150}) {
      const Sparse matrix = random_matrix(size, links, static_cast<unsigned>(size));
      EXPECT_LT(residual(matrix, CholeskyFactor(matrix, Precision::double_precision)), 1e-13) << size << " " << links;
      EXPECT_LT(residual(matrix, CholeskyFactor(matrix, Precision::single_precision)), 1e-4) << size << " " << links;
    }
  }
  EXPECT_EQ(CholeskyFactor(Sparse(0, 0), Precision::double_precision).stored_numbers(), 0);
}

TEST(CholeskyFactor, AgreesWithADenseFactorOnGrids) {
  for (const bool ordered : {false, true}) {
    const Sparse matrix = grid_matrix(7, ordered, 0.01);
    const Eigen::MatrixXd full = dense(matrix);
    const Eigen::MatrixXd exact = full.llt().solve(Eigen::MatrixXd::Identity(full.rows(), full.cols()));
    const CholeskyFactor factor(matrix, Precision::double_precision);
    EXPECT_LT((inverse(factor) - exact).norm() / exact.norm(), 1e-13);
  }
  // The order pays: less is stored than in the grid's own order.
  const auto stored = [](bool ordered) {
    return CholeskyFactor(grid_matrix(14, ordered, 0.01), Precision::double_precision).stored_numbers();
  };
  EXPECT_LT(stored(true), stored(false) / 2);
}

TEST(CholeskyFactor, OfNewNumbersIsTheFactorMadeAnew) {
  const Sparse first = grid_matrix(6, true, 0.01), second = grid_matrix(6, true, 2.0);
  for (const Precision precision : {Precision::single_precision, Precision::double_precision}) {
    CholeskyFactor factor(first, precision);
    factor.factorize(second, precision);
    EXPECT_EQ(inverse(factor), inverse(CholeskyFactor(second, precision)));
    // The same holds in the other precision, and for another pattern.
    factor.factorize(second, Precision::double_precision);
    EXPECT_EQ(inverse(factor), inverse(CholeskyFactor(second, Precision::double_precision)));
    const Sparse other = random_matrix(50, 1.5, 3);
    factor.factorize(other, precision);
    EXPECT_EQ(inverse(factor), inverse(CholeskyFactor(other, precision)));
  }
}

TEST(CholeskyFactor, NamesTheUnknownWhosePivotIsNotPositive) {
  Sparse matrix = random_matrix(60, 1.5, 5);
  const Sparse sound = matrix;
  matrix.coeffRef(41, 41) = -1;
  CholeskyFactor factor;
  try {
    factor.factorize(matrix, Precision::double_precision);
    ADD_FAILURE() << "a matrix that is not positive definite was factored";
  } catch (const RunError& error) {
    EXPECT_NE(std::string(error.what()).find("unknown 41"), std::string::npos) << error.what();
  }
  matrix.coeffRef(41, 41) = std::nan("");
  EXPECT_THROW(factor.factorize(matrix, Precision::double_precision), RunError);
  factor.factorize(sound, Precision::double_precision);
  EXPECT_LT(residual(sound, factor), 1e-13);
}

// A symmetric matrix of 3 x 3 blocks on a grid in an order of little fill, blocks on the diagonal stored whole, as
// HessianMatrix stores them; `shift` is added to the diagonal of a positive semi-definite sum.
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

Eigen::VectorXd solve(ChangingFactor& factor, const Eigen::VectorXd& b) {
  Eigen::VectorXd x(b.size());
  factor.solve(b.data(), x.data());
  return x;
}

ChangingFactor factor_of(const Sparse& matrix) {
  ChangingFactor factor;
  factor.analyze(matrix);
  EXPECT_TRUE(factor.factorize(matrix));
  return factor;
}

TEST(ChangingFactor, SolvesLikeADenseFactor) {
  std::vector<Sparse> matrices;
  for (const int n : {1, 2, 3, 6}) matrices.push_back(block_matrix(n, 0.01, static_cast<unsigned>(n)));
  for (const double links : {0.0, 0.6, 3.0, 20.0}) {
    for (const int size : {1, 7, 8, 9, 40, 300}) matrices.push_back(random_matrix(size, links, 3));
  }
  for (const Sparse& matrix : matrices) {
    ChangingFactor factor = factor_of(matrix);
    const Eigen::VectorXd b = Eigen::VectorXd::Random(matrix.rows());
    const Eigen::VectorXd exact = dense(matrix).ldlt().solve(b);
    EXPECT_LT((solve(factor, b) - exact).norm(), 1e-11 * exact.norm()) << matrix.rows();
    Eigen::VectorXd in_place = b;
    factor.solve(in_place.data(), in_place.data());
    EXPECT_EQ(in_place, solve(factor, b));
    EXPECT_GE(factor.stored_numbers(), matrix.rows());
  }
}

TEST(ChangingFactor, OfNewNumbersHasTheBitsOfOneMadeAnew) {
  const Sparse first = block_matrix(7, 0.01, 1), second = block_matrix(7, 0.5, 2);
  const Eigen::VectorXd b = Eigen::VectorXd::Random(first.rows());
  ChangingFactor factor = factor_of(first);
  const Eigen::VectorXd x = solve(factor, b);
  const std::int64_t numbers = factor.stored_numbers();
  ASSERT_TRUE(factor.factorize(second));
  ChangingFactor anew = factor_of(second);
  EXPECT_EQ(solve(factor, b), solve(anew, b));
  ASSERT_TRUE(factor.factorize(first));
  EXPECT_EQ(solve(factor, b), x);
  EXPECT_EQ(factor.stored_numbers(), numbers);
  ChangingFactor moved = std::move(factor);
  EXPECT_EQ(solve(moved, b), x);
  ASSERT_TRUE(moved.factorize(second));
  EXPECT_EQ(solve(moved, b), solve(anew, b));
}

TEST(ChangingFactor, KnowsWhichMatricesArePositiveDefinite) {
  const Sparse matrix = block_matrix(5, 0.0, 4);
  const Eigen::VectorXd b = Eigen::VectorXd::Random(matrix.rows());
  const Eigen::VectorXd eigenvalues = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(dense(matrix)).eigenvalues();
  const auto shifted = [&](double shift) {
    Sparse result = matrix;
    for (int i = 0; i < result.rows(); ++i) result.coeffRef(i, i) += shift;
    return result;
  };
  const Sparse sound = shifted(0.1);
  ChangingFactor factor = factor_of(sound);
  const Eigen::VectorXd x = solve(factor, b);
  // So far below zero that a few eigenvalues, many and all of them are negative (three are 0 without a shift: moving
  // all vertices alike costs nothing); and just not one.
  for (const Eigen::Index negative : {3, 4, 7, 100, 374, 375}) {
    const double next = negative < eigenvalues.size() ? eigenvalues[negative] : 2 * eigenvalues[negative - 1];
    const Sparse indefinite = shifted(-(eigenvalues[negative - 1] + next) / 2);
    EXPECT_FALSE(factor.factorize(indefinite)) << negative;
    ASSERT_TRUE(factor.factorize(sound));
    EXPECT_EQ(solve(factor, b), x);
  }
  EXPECT_TRUE(factor.factorize(shifted(-eigenvalues[0] + 1e-9)));
  for (const int place : {0, 41, 374}) {
    Sparse broken = sound;
    broken.coeffRef(place, place) = std::nan("");
    EXPECT_FALSE(factor.factorize(broken));
    broken.coeffRef(place, place) = 0;
    EXPECT_FALSE(factor.factorize(broken));
  }
  ASSERT_TRUE(factor.factorize(sound));
  EXPECT_EQ(solve(factor, b), x);
}

// A dense front, and where its numbers stand in the kernels' storage.
struct StoredFront {
  FrontShape shape;
  AlignedVector<double> columns, update;

  StoredFront(const Eigen::MatrixXd& full, int pivots) : shape{pivots, static_cast<int>(full.rows()) - pivots} {
    columns.resize(column_numbers(shape));
    update.resize(update_numbers(shape));
    for (int j = 0; j < full.rows(); ++j) {
      for (int i = j; i < full.rows(); ++i) number(i, j) = full(i, j);
    }
  }

  double& number(int i, int j) {
    if (j >= shape.pivots) return update[(j - shape.pivots) * padded_rows(shape.rows) + i - shape.pivots];
    const int strip = j / block_rows, row = padded_place(shape, i);
    return columns[strip_begin(shape, strip) +
                   std::int64_t(row / block_rows - strip) * block_rows * strip_width(shape, strip) +
                   j % block_rows * block_rows + row % block_rows];
  }
};

// Plain elimination: column after column, each number loses its products in the order of the pivots.
void eliminate_plainly(Eigen::MatrixXd& front, int pivots, bool fused) {
  const auto size = static_cast<int>(front.rows());
  for (int j = 0; j < size; ++j) {
    for (int k = 0; k < std::min(j, pivots); ++k) {
      for (int i = j; i < size; ++i)
        front(i, j) =
            fused ? std::fma(-front(j, k), front(i, k), front(i, j)) : front(i, j) - front(j, k) * front(i, k);
    }
    if (j < pivots) front.col(j).tail(size - j) *= 1 / std::sqrt(front(j, j));
  }
}

// Tests every instruction set with all sizes around its registers and beyond the strips that are taken together: the bits
// are those of plain elimination, whose pivots' columns agree with a dense factor.
TEST(Kernels, EliminateDenseFronts) {
  std::vector<std::pair<int, int>> shapes = {{128, 1}, {129, 40}, {150, 90}, {270, 0}, {264, 24}};  // pivots, rows
  for (int size = 1; size < 42; ++size) {
    for (const int pivots : {1, 2, 3, 4, 5, 9, size / 2, size}) {
      if (pivots >= 1 && pivots <= size) shapes.emplace_back(pivots, size - pivots);
    }
  }
  for (const auto& [pivots, rows] : shapes) {
    const int size = pivots + rows;
    const Eigen::MatrixXd random = Eigen::MatrixXd::Random(size, size);
    const Eigen::MatrixXd full = random * random.transpose() + Eigen::MatrixXd::Identity(size, size);
    Eigen::MatrixXd fused = full, rounded = full;
    eliminate_plainly(fused, pivots, true);
    eliminate_plainly(rounded, pivots, false);
    const Eigen::MatrixXd lower = full.llt().matrixL();
    EXPECT_LT((fused - lower).leftCols(pivots).triangularView<Eigen::Lower>().toDenseMatrix().norm(),
              1e-11 * lower.norm());
    for (int v = 0; v < runnable_variants(); ++v) {
      StoredFront front(full, pivots);
      ASSERT_EQ(linear_kernels(v).eliminate(front.shape, front.columns.data(), front.update.data()), -1);
      const auto different_from = [&](const Eigen::MatrixXd& plain) {
        int different = 0;
        for (int j = 0; j < size; ++j) {
          for (int i = j; i < size; ++i) different += front.number(i, j) != plain(i, j);
        }
        return different;
      };
      // Whether products are fused is a matter of the instruction set; all or none are.
      EXPECT_EQ(std::min(different_from(fused), different_from(rounded)), 0)
          << variant_name(v) << ": " << pivots << " pivots, " << rows << " rows";
      StoredFront indefinite(full, pivots);
      indefinite.number(pivots - 1, pivots - 1) = -1;
      EXPECT_EQ(linear_kernels(v).eliminate(front.shape, indefinite.columns.data(), indefinite.update.data()),
                pivots - 1);
    }
  }
}

// Both halves of a solve with one front, against the dense columns of L.
TEST(Kernels, SolveWithDenseFronts) {
  for (int v = 0; v < runnable_variants(); ++v) {
    for (const auto& [pivots, rows] :
         std::vector<std::pair<int, int>>{{1, 0}, {1, 1}, {3, 9}, {8, 8}, {9, 30}, {13, 2}, {24, 17}, {40, 0}}) {
      const int size = pivots + rows;
      Eigen::MatrixXd lower = Eigen::MatrixXd::Random(size, size);
      lower.diagonal().array() += 3;
      StoredFront front(lower, pivots);
      // The front's rows are every other unknown after its pivots.
      std::vector<std::int32_t> places;
      for (int i = 0; i < rows; ++i) places.push_back(pivots + 2 * i + 1);
      Eigen::VectorXd x = Eigen::VectorXd::Random(size + rows), expected = x;
      AlignedVector<double> scratch(row_blocks_of(front.shape) * block_rows, 7.0);
      const auto triangle = lower.topLeftCorner(pivots, pivots).triangularView<Eigen::Lower>();
      expected.head(pivots) = triangle.solve(x.head(pivots));
      const Eigen::VectorXd taken = lower.bottomLeftCorner(rows, pivots) * expected.head(pivots);
      for (int i = 0; i < rows; ++i) expected[places[i]] -= taken[i];
      linear_kernels(v).solve_down(front.shape, front.columns.data(), places.data(), x.data(), x.data(),
                                   scratch.data());
      EXPECT_LT((x - expected).norm(), 1e-12 * expected.norm()) << variant_name(v) << " " << pivots << ", " << rows;

      Eigen::VectorXd below(rows);
      for (int i = 0; i < rows; ++i) below[i] = expected[places[i]];
      expected.head(pivots) =
          triangle.transpose().solve(expected.head(pivots) - lower.bottomLeftCorner(rows, pivots).transpose() * below);
      linear_kernels(v).solve_up(front.shape, front.columns.data(), places.data(), x.data(), x.data(), scratch.data());
      EXPECT_LT((x - expected).norm(), 1e-12 * expected.norm()) << variant_name(v) << " " << pivots << ", " << rows;
    }
  }
}

}  // namespace
}  // namespace supple
