// Tests the kernels that eliminate and solve with one dense front, in every instruction set.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "base/aligned.h"
#include "base/variants.h"
#include "sim/linear/changing_factor.h"
#include "sim/linear/front_layout.h"
#include "sim/linear/linear_kernels.h"

namespace supple {
namespace front_kernels_test {

// Holds a dense front in the kernels' storage, and finds its numbers there.
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

// Eliminates without optimisation: column after column, the products are subtracted from each number in the order of
// the pivots.
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

// Tests every instruction set with all sizes around its registers and beyond the strips that are processed together:
// the bits are those of plain elimination, whose pivots' columns agree with a dense factor.
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
      // The instruction set decides whether products are fused; either all are, or none.
      EXPECT_EQ(std::min(different_from(fused), different_from(rounded)), 0)
          << variant_name(v) << ": " << pivots << " pivots, " << rows << " rows";
      StoredFront indefinite(full, pivots);
      indefinite.number(pivots - 1, pivots - 1) = -1;
      EXPECT_EQ(linear_kernels(v).eliminate(front.shape, indefinite.columns.data(), indefinite.update.data()),
                pivots - 1);
    }
  }
}

// Compares both halves of a solve with one front, in the precision of T, with the dense columns of L.
template <class T>
void expect_solves(LinearKernels::FrontStep<T> down, LinearKernels::FrontStep<T> up, int pivots, int rows,
                   double tolerance) {
  const int size = pivots + rows;
  Eigen::MatrixXd lower = Eigen::MatrixXd::Random(size, size);
  lower.diagonal().array() += 3;
  StoredFront front(lower, pivots);
  invert_triangles(front.shape, front.columns.data());
  const AlignedVector<T> columns(front.columns.begin(), front.columns.end());
  // The rows of the front are every second unknown after its pivots.
  std::vector<std::int32_t> places;
  for (int i = 0; i < rows; ++i) places.push_back(pivots + 2 * i + 1);
  using Vector = Eigen::Matrix<T, Eigen::Dynamic, 1>;
  Vector x = Vector::Random(size + rows);
  Eigen::VectorXd expected = x.template cast<double>();
  AlignedVector<T> scratch(row_blocks_of(front.shape) * block_rows, T(7));
  const auto triangle = lower.topLeftCorner(pivots, pivots).triangularView<Eigen::Lower>();
  expected.head(pivots) = triangle.solve(expected.head(pivots)).eval();
  const Eigen::VectorXd taken = lower.bottomLeftCorner(rows, pivots) * expected.head(pivots);
  for (int i = 0; i < rows; ++i) expected[places[i]] -= taken[i];
  down(front.shape, columns.data(), places.data(), x.data(), x.data(), scratch.data());
  EXPECT_LT((x.template cast<double>() - expected).norm(), tolerance * expected.norm()) << pivots << ", " << rows;

  Eigen::VectorXd below(rows);
  for (int i = 0; i < rows; ++i) below[i] = expected[places[i]];
  expected.head(pivots) =
      triangle.transpose().solve(expected.head(pivots) - lower.bottomLeftCorner(rows, pivots).transpose() * below);
  up(front.shape, columns.data(), places.data(), x.data(), x.data(), scratch.data());
  EXPECT_LT((x.template cast<double>() - expected).norm(), tolerance * expected.norm()) << pivots << ", " << rows;
}

TEST(Kernels, SolveWithDenseFronts) {
  for (int v = 0; v < runnable_variants(); ++v) {
    const testing::ScopedTrace trace(__FILE__, __LINE__, variant_name(v));
    const LinearKernels& kernels = linear_kernels(v);
    for (const auto& [pivots, rows] : std::vector<std::pair<int, int>>{{1, 0},
                                                                       {1, 1},
                                                                       {2, 5},
                                                                       {3, 9},
                                                                       {4, 4},
                                                                       {5, 1},
                                                                       {6, 12},
                                                                       {7, 3},
                                                                       {8, 8},
                                                                       {9, 30},
                                                                       {13, 2},
                                                                       {24, 17},
                                                                       {40, 0}}) {
      expect_solves<double>(kernels.front_down_double, kernels.front_up_double, pivots, rows, 1e-12);
      expect_solves<float>(kernels.front_down_float, kernels.front_up_float, pivots, rows, 1e-4);
    }
  }
}

}  // namespace front_kernels_test
}  // namespace supple
