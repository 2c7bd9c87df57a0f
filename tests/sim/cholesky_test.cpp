#include "sim/linear/cholesky.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <chrono>
#include <csignal>
#include <random>
#include <thread>

#include "base/error.h"
#include "base/variants.h"
#include "sim/linear/parted_solve.h"
#include "support/bodies.h"
#include "support/sparse_matrices.h"

namespace supple {
namespace cholesky_test {

using test::dense;
using test::grid_matrix;
using test::random_matrix;
using test::Sparse;

Eigen::MatrixX3d solve(const CholeskyFactor& factor, const Eigen::MatrixX3d& b) {
  const int size = factor.size();
  std::vector<double> right(3 * size), x(3 * size);
  AlignedVector<double> scratch;
  for (int i = 0; i < size; ++i) {
    for (int c = 0; c < 3; ++c) right[3 * i + c] = b(i, c);
  }
  factor.solve(right.data(), x.data(), scratch);
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

// Captures all bits of a factor by its effect on the columns of the identity.
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
  // The order is worthwhile: less is stored than in the grid's own order.
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

// Solves L x = b and L^T x = b, with all strips and with those on the path of one unknown to the root.
template <class T>
void expect_halves(const Sparse& matrix, LinearKernels::Solve<T> down, LinearKernels::Solve<T> up,
                   void (*down_many)(const FactorView&, const std::int32_t*, int, T*), double tolerance) {
  const Precision precision = sizeof(T) == 4 ? Precision::single_precision : Precision::double_precision;
  const CholeskyFactor factor(matrix, precision);
  const FactorView view = factor.view();
  const int size = factor.size();
  const Eigen::MatrixXd lower = dense(matrix).llt().matrixL();
  using Rows = Eigen::Matrix<T, Eigen::Dynamic, 4, Eigen::RowMajor>;
  const Rows b = Rows::Random(size, 4);
  AlignedVector<T> scratch(factor.front_numbers());
  const auto distance = [&](const Rows& found, const Eigen::MatrixXd& expected) {
    return (found.template cast<double>() - expected).leftCols(3).norm() / expected.leftCols(3).norm();
  };
  Rows x = b;
  down(view, nullptr, 0, x.data(), scratch.data());
  EXPECT_LT(distance(x, lower.triangularView<Eigen::Lower>().solve(b.template cast<double>())), tolerance);
  Rows whole = b;
  up(view, nullptr, 0, whole.data(), scratch.data());
  EXPECT_LT(distance(whole, lower.transpose().triangularView<Eigen::Upper>().solve(b.template cast<double>())),
            tolerance);

  for (const int unknown : {0, size / 3, size - 1}) {
    const FactorPart part = paths_to_root(factor, {unknown});
    const auto count = static_cast<int>(part.size());
    Rows some = b;
    up(view, part.data(), count, some.data(), scratch.data());
    Eigen::VectorXd unit = Eigen::VectorXd::Zero(size);
    unit[unknown] = 1;
    const Eigen::VectorXd column = lower.triangularView<Eigen::Lower>().solve(unit);
    Rows from_unit = Rows::Zero(size, 4);
    from_unit.row(unknown).setOnes();
    down(view, part.data(), count, from_unit.data(), scratch.data());
    AlignedVector<T> many(std::size_t(size) * columns_together, T(0));
    many[std::size_t(unknown) * columns_together + 5] = 1;
    down_many(view, part.data(), count, many.data());
    for (const std::int32_t strip : part) {
      for (int i = factor.first_column(strip); i < factor.first_column(strip) + factor.width(strip); ++i) {
        EXPECT_EQ(some.row(i).template head<3>(), whole.row(i).template head<3>());
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(from_unit(i, c), column[i], tolerance * column.norm());
        EXPECT_NEAR(many[std::size_t(i) * columns_together + 5], column[i], tolerance * column.norm());
      }
    }
  }
}

TEST(Kernels, SolveForThreeRightHandSidesWithAllStripsOrThoseOfAPath) {
  std::vector<Sparse> matrices = {grid_matrix(7, true, 0.01)};
  for (const double links : {0.3, 1.0, 3.0, 20.0}) {
    for (const int size : {1, 5, 8, 9, 17, 40, 150})
      matrices.push_back(random_matrix(size, links, static_cast<unsigned>(size)));
  }
  for (int v = 0; v < runnable_variants(); ++v) {
    const LinearKernels& k = linear_kernels(v);
    for (const Sparse& matrix : matrices) {
      expect_halves<float>(matrix, k.down_float, k.up_float, k.down_many_float, 1e-4);
      expect_halves<double>(matrix, k.down_double, k.up_double, k.down_many_double, 1e-13);
    }
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

TEST(Cholesky, SolvesTheSystemOfABodyInBothPrecisions) {
  const BodyDescription body = test::bar(Corotated{1e5, 2e5}, test::Held::nothing, Precision::double_precision, 3);
  const Model exact = build_model(body);
  BodyDescription rough = body;
  rough.precision = Precision::single_precision;
  const Model single = build_model(rough);
  const Positions b = test::shaken(Positions::Zero(exact.free, 3), 1, 9);
  Positions x(exact.free, 3), y(exact.free, 3);
  AlignedVector<double> scratch;
  exact.factor.solve(b.data(), x.data(), scratch);
  single.factor.solve(b.data(), y.data(), scratch);
  EXPECT_LT((x - y).norm(), 1e-4 * x.norm());

  // Solves A x = b, with A applied as the second derivative of the quadratic part: M/h^2 x + L x, element by element.
  Positions product(exact.free, 3);
  for (int v = 0; v < exact.free; ++v) product.row(v) = exact.mass[v] / (exact.time_step * exact.time_step) * x.row(v);
  for (Eigen::Index e = 0; e < body.mesh.tets.rows(); ++e) {
    Mat3 edges;
    for (int k = 0; k < 3; ++k)
      edges.col(k) =
          (body.mesh.rest.row(body.mesh.tets(e, k + 1)) - body.mesh.rest.row(body.mesh.tets(e, 0))).transpose();
    Eigen::Matrix<double, 4, 3> g;
    g.bottomRows<3>() = edges.inverse();
    g.row(0) = -g.bottomRows<3>().colwise().sum();
    const double weight = edges.determinant() / 6 * exact.stiffness[0].k;
    for (int a = 0; a < 4; ++a) {
      for (int c = 0; c < 4; ++c) {
        product.row(exact.internal_of[body.mesh.tets(e, a)]) +=
            weight * g.row(a).dot(g.row(c)) * x.row(exact.internal_of[body.mesh.tets(e, c)]);
      }
    }
  }
  EXPECT_LT((product - b).norm(), 1e-10 * b.norm());
}

}  // namespace cholesky_test
}  // namespace supple
