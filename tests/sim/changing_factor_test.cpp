#include "sim/linear/changing_factor.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "support/sparse_matrices.h"

namespace supple {
namespace changing_factor_test {

using test::block_matrix;
using test::dense;
using test::random_matrix;
using test::Sparse;

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
  // The shifts go so far below zero that a few, many, and all of the eigenvalues are negative, and finally just not
  // one. (Without a shift three of them are 0, because moving all vertices alike costs nothing.)
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

TEST(ChangingFactor, SolvesInSinglePrecisionToItsRoundOff) {
  for (const Sparse& matrix : {block_matrix(7, 0.5, 2), random_matrix(300, 3, 3), random_matrix(9, 3, 3)}) {
    ChangingFactor factor(Precision::single_precision);
    factor.analyze(matrix);
    ASSERT_TRUE(factor.factorize(matrix));
    ChangingFactor exact = factor_of(matrix);
    // Of forces that single precision alone cannot hold.
    for (const double scale : {1.0, 1e-60, 1e60}) {
      const Eigen::VectorXd b = scale * Eigen::VectorXd::Random(matrix.rows());
      const Eigen::VectorXd x = solve(factor, b), expected = solve(exact, b);
      EXPECT_LT((x - expected).norm(), 1e-5 * expected.norm());
      EXPECT_GT((x - expected).norm(), 0);
    }
    EXPECT_EQ(factor.stored_numbers(), exact.stored_numbers());
    EXPECT_EQ(factor.operations(), exact.operations());
  }
}

}  // namespace changing_factor_test
}  // namespace supple
