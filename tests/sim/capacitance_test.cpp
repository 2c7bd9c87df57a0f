// Tests the small system of stiff directions against dense matrices, for models of one part and of several.
#include "sim/contact/capacitance.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <numeric>
#include <random>

#include "support/sparse_matrices.h"

namespace supple {
namespace capacitance_test {

using Directions = std::vector<StiffDirection>;
using Random = std::mt19937;

// Holds a matrix with a block for each part, as that of a joined model, and the inverse of the matrix.
struct Bodies {
  System system;
  std::vector<Part> parts;
  Eigen::MatrixXd inverse;
  std::vector<int> first_column{0};  // of coarse motions, by part

  // columns: how many motions a part has, if it has any
  Bodies(int count, int size, int columns = 4) {
    std::vector<Eigen::Triplet<double>> entries;
    for (int p = 0; p < count; ++p) {
      const int first = p * size;
      const test::Sparse block = test::random_matrix(size, 3, static_cast<unsigned>(p + 1));
      for (int column = 0; column < size; ++column) {
        for (test::Sparse::InnerIterator at(block, column); at; ++at)
          entries.emplace_back(first + static_cast<int>(at.row()), first + column, at.value());
        if (column > 0) entries.emplace_back(first + column, first + column - 1, 0.01);
      }
      Part part;
      part.first_free = first;
      part.free = size;
      parts.push_back(part);
      first_column.push_back(first_column.back() + (p % 3 == 1 ? 0 : columns));
    }
    system.id = 1;
    system.matrix.resize(count * size, count * size);
    system.matrix.setFromTriplets(entries.begin(), entries.end());
    system.factor.factorize(system.matrix, Precision::double_precision);
    inverse = test::dense(system.matrix).inverse();
  }
  int part_of(std::int32_t vertex) const { return vertex / parts[0].free; }
};

Vec3 random_axis(Random& random) {
  std::normal_distribution<double> number;
  return Vec3(number(random), number(random), number(random)).normalized();
}

// Makes a direction of a vertex of one part, and of a triangle of another one, if that is another one.
StiffDirection random_direction(const Bodies& bodies, int part, int other, const Vec3& axis, Random& random) {
  const auto vertex_of = [&](int p) {
    const Part& of = bodies.parts[p];
    return of.first_free + static_cast<std::int32_t>(random() % static_cast<unsigned>(of.free - 2));
  };
  std::uniform_real_distribution<double> between(0.5, 2);
  const double stiffness = between(random) / bodies.inverse.diagonal().mean();
  const std::int32_t vertex = vertex_of(part), corner = vertex_of(other);
  if (part == other) return {ContactStencil::at_vertex(vertex), axis, stiffness};
  ContactStencil stencil;
  stencil.count = stencil.free = 4;
  if (vertex < corner) {
    stencil.vertex = {vertex, corner, corner + 1, corner + 2};
    stencil.weight = {1, -0.5, -0.3, -0.2};
  } else {
    stencil.vertex = {corner, corner + 1, corner + 2, vertex};
    stencil.weight = {-0.5, -0.3, -0.2, 1};
  }
  return {stencil, axis, stiffness};
}

// Makes directions of neighbours in a ring of parts, of some that are further from each other, and of parts alone. Each
// place has three directions. axes: those that occur, or none for axes of any direction.
Directions random_directions(const Bodies& bodies, int places, const std::vector<Vec3>& axes, unsigned seed) {
  Random random(seed);
  const int count = static_cast<int>(bodies.parts.size());
  Directions all;
  for (int i = 0; i < places; ++i) {
    const int part = static_cast<int>(random() % static_cast<unsigned>(count));
    const int step = i % 7 == 0 ? 3 : i % 2;
    StiffDirection made = random_direction(bodies, part, (part + step) % count, Vec3::UnitX(), random);
    for (std::size_t k = 0; k < 3; ++k) {
      made.axis = axes.empty() ? random_axis(random) : axes[k % axes.size()];
      all.push_back(made);
    }
  }
  return all;
}

Directions sorted(Directions directions) {
  std::stable_sort(directions.begin(), directions.end(), [](const StiffDirection& a, const StiffDirection& b) {
    return a.stencil.vertex[0] < b.stencil.vertex[0];
  });
  return directions;
}

// Leaves out each direction with some probability.
Directions some_of(const Directions& all, double share, Random& random) {
  Directions some;
  for (const StiffDirection& direction : all) {
    if (static_cast<double>(random() % 1000) < 1000 * share) some.push_back(direction);
  }
  return sorted(some);
}

Eigen::MatrixXd dense_matrix(const Bodies& bodies, const Directions& directions) {
  const auto n = std::ssize(directions);
  Eigen::MatrixXd weights = Eigen::MatrixXd::Zero(bodies.inverse.rows(), n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const ContactStencil& stencil = directions[i].stencil;
    for (int k = 0; k < stencil.free; ++k) weights(stencil.vertex[k], i) += stencil.weight[k];
  }
  Eigen::MatrixXd matrix = weights.transpose() * bodies.inverse * weights;
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j) matrix(i, j) *= directions[i].axis.dot(directions[j].axis);
    matrix(i, i) += 1 / directions[i].stiffness;
  }
  return matrix;
}

// Holds motions of all parts, of any numbers, which belong to the direction and the pose. D is positive definite.
struct Motions {
  AddedMotions added;
  std::vector<Eigen::MatrixXd> difference;  // by part

  Motions(const Bodies& bodies, std::uint64_t pose) {
    Random random(static_cast<unsigned>(pose));
    std::normal_distribution<double> normal;
    for (std::size_t part = 0; part < bodies.parts.size(); ++part) {
      const int count = bodies.first_column[part + 1] - bodies.first_column[part];
      const Eigen::MatrixXd any = Eigen::MatrixXd::NullaryExpr(count, count, [&] { return normal(random); });
      difference.push_back(bodies.inverse.diagonal().mean() / std::max(count, 1) * any * any.transpose());
    }
    added.pose = pose;
    added.first_column = bodies.first_column;
    added.difference = [this](int part) -> const Eigen::MatrixXd& { return difference[std::size_t(part)]; };
    added.add_row = [&bodies, pose](const StiffDirection& s, double* row) {
      for (int k = 0; k < s.stencil.free; ++k) {
        const int part = bodies.part_of(s.stencil.vertex[k]);
        for (int c = bodies.first_column[part]; c < bodies.first_column[part + 1]; ++c)
          row[c] += s.stencil.weight[k] * std::sin(double(pose) + s.stencil.vertex[k] + 3.0 * c * s.axis.x());
      }
    };
  }
  // Returns W of some directions.
  Eigen::MatrixXd rows(const Directions& directions) const {
    Eigen::MatrixXd transposed = Eigen::MatrixXd::Zero(added.first_column.back(), std::ssize(directions));
    for (Eigen::Index i = 0; i < transposed.cols(); ++i) added.add_row(directions[std::size_t(i)], &transposed(0, i));
    return transposed.transpose();
  }
  // Returns W D W^T.
  Eigen::MatrixXd products(const Directions& directions) const {
    const Eigen::MatrixXd w = rows(directions);
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(w.rows(), w.rows());
    for (std::size_t part = 0; part < difference.size(); ++part) {
      const Eigen::MatrixXd own = w.middleCols(added.first_column[part], difference[part].rows());
      sum += own * difference[part] * own.transpose();
    }
    return sum;
  }
};

Eigen::VectorXf solved(const Capacitance& system) {
  Eigen::VectorXf answer(std::ssize(system.directions()));
  for (Eigen::Index i = 0; i < answer.size(); ++i) answer[i] = std::sin(1.0f + 2.0f * static_cast<float>(i));
  system.solve(answer);
  return answer;
}

void expect_dense(const Bodies& bodies, const Capacitance& system, const Motions* motions = nullptr) {
  Eigen::MatrixXd matrix = dense_matrix(bodies, system.directions());
  if (motions != nullptr) matrix += motions->products(system.directions());
  Eigen::VectorXd wanted(matrix.rows());
  for (Eigen::Index i = 0; i < wanted.size(); ++i) wanted[i] = std::sin(1.0f + 2.0f * static_cast<float>(i));
  wanted = matrix.llt().solve(wanted);
  EXPECT_LT((solved(system).cast<double>() - wanted).norm(), 2e-5 * wanted.norm());
}

void expect_rows(const Capacitance& system, const Motions& motions) {
  const Eigen::MatrixXd w = motions.rows(system.directions());
  Eigen::VectorXd y(w.cols());
  Eigen::VectorXf f(w.rows());
  for (Eigen::Index c = 0; c < y.size(); ++c) y[c] = std::cos(2.0 + double(c));
  for (Eigen::Index i = 0; i < f.size(); ++i) f[i] = std::cos(1.0f + 3.0f * static_cast<float>(i));
  EXPECT_LT((system.seen_by_directions(y).cast<double>() - w * y).norm(), 1e-5 * (w * y).norm());
  const Eigen::VectorXd back = w.transpose() * f.cast<double>();
  EXPECT_LT((system.seen_by_motions(f) - back).norm(), 1e-5 * back.norm());
}

const std::vector<Vec3> world_axes = {Vec3::UnitX(), Vec3::UnitY(), Vec3::UnitZ()};

// The groups of directions of some parts come and go, grow and shrink, with motions and without. Two threads make the
// same bits as one.
void expect_dense_whatever_comes_and_goes(const Bodies& bodies, const std::vector<Vec3>& axes) {
  const Directions all = random_directions(bodies, 70, axes, 1);
  Random random(2);
  Threads two(2);
  Capacitance system, by_two;
  system.begin_step(bodies.system, bodies.parts);
  by_two.begin_step(bodies.system, bodies.parts);
  for (int round = 0; round < 16; ++round) {
    const Motions made(bodies, 1 + static_cast<std::uint64_t>(round) / 4);
    const Motions* motions = round % 3 > 0 ? &made : nullptr;
    for (Capacitance* one : {&system, &by_two}) one->add_motions(motions != nullptr ? &made.added : nullptr);
    const Directions wanted = some_of(all, round % 5 == 0 ? 0.1 : round % 5 == 1 ? 0.97 : 0.6, random);
    ASSERT_TRUE(system.set(bodies.system, wanted, nullptr));
    ASSERT_TRUE(by_two.set(bodies.system, wanted, &two));
    EXPECT_EQ(system.directions().size(), wanted.size());
    expect_dense(bodies, system, motions);
    // Few and many directions are appended, in one call or in two.
    for (int call = 0; call < 1 + round % 2; ++call) {
      const Directions more =
          some_of(random_directions(bodies, round % 4 == 3 ? 60 : 8, axes, 10u * round + call), 0.7, random);
      ASSERT_TRUE(system.append(bodies.system, more, nullptr));
      ASSERT_TRUE(by_two.append(bodies.system, more, &two));
      expect_dense(bodies, system, motions);
      if (motions != nullptr) expect_rows(system, *motions);
    }
    EXPECT_EQ(solved(system), solved(by_two));
  }
}

TEST(Capacitance, IsThatOfTheDenseSystemWhateverComesAndGoes) {
  for (const std::vector<Vec3>& axes : {std::vector<Vec3>(), world_axes, {Vec3::UnitX(), Vec3(0.6, 0.8, 0)}}) {
    expect_dense_whatever_comes_and_goes(Bodies(8, 30), axes);
    expect_dense_whatever_comes_and_goes(Bodies(1, 240), axes);
    // With 50 motions, directions are at times more than motions, and at times fewer.
    expect_dense_whatever_comes_and_goes(Bodies(1, 240, 50), axes);
  }
}

TEST(Capacitance, JoinsListsThatANewDirectionCouples) {
  for (const int parts : {1, 5}) {
    const Bodies bodies(parts, 150 / parts);
    const Motions motions(bodies, 1);
    for (const Motions* added : {static_cast<const Motions*>(nullptr), &motions}) {
      Capacitance system;
      system.add_motions(added != nullptr ? &added->added : nullptr);
      system.begin_step(bodies.system, bodies.parts);
      ASSERT_TRUE(system.set(bodies.system, sorted(random_directions(bodies, 40, world_axes, 3)), nullptr));
      ASSERT_TRUE(system.append(bodies.system, random_directions(bodies, 1, {Vec3(0.6, 0, 0.8)}, 4), nullptr));
      expect_dense(bodies, system, added);
    }
  }
}

// Groups that go leave nothing in the factor of those that stay.
TEST(Capacitance, ForgetsGroupsThatHaveGone) {
  const Bodies bodies(6, 30);
  const Motions motions(bodies, 1);
  const Directions all = sorted(random_directions(bodies, 40, {}, 5));
  for (int gone = 0; gone < 6; ++gone) {
    Capacitance system;
    system.add_motions(&motions.added);
    system.begin_step(bodies.system, bodies.parts);
    ASSERT_TRUE(system.set(bodies.system, all, nullptr));
    Directions left;
    for (const StiffDirection& s : all) {
      if (bodies.part_of(s.stencil.vertex[0]) != gone) left.push_back(s);
    }
    ASSERT_LT(left.size(), all.size());
    ASSERT_TRUE(system.set(bodies.system, left, nullptr));
    expect_dense(bodies, system, &motions);
  }
}

// Memory that is left from larger groups must not change the order of any sum. Many groups are as small as the products
// that Eigen computes in another way than large ones.
void expect_that_steps_are_independent(const Bodies& bodies, int directions_before) {
  const Motions one(bodies, 1), other(bodies, 2);
  const Directions earlier = sorted(random_directions(bodies, directions_before, {}, 6));
  for (unsigned seed = 7; seed < 27; ++seed) {
    const Directions all = random_directions(bodies, seed % 2 == 0 ? 50 : 20, {}, seed);
    Capacitance used, fresh;
    used.add_motions(&one.added);
    used.begin_step(bodies.system, bodies.parts);
    ASSERT_TRUE(used.set(bodies.system, earlier, nullptr));
    std::vector<Eigen::VectorXf> answers;
    for (Capacitance* system : {&used, &fresh}) {
      system->add_motions(&other.added);
      system->begin_step(bodies.system, bodies.parts);
      for (int round = 0; round < 4; ++round) {
        const Directions wanted = sorted(Directions(all.begin(), all.end() - 3 * (3 - round)));
        ASSERT_TRUE(system->set(bodies.system, wanted, nullptr));
        ASSERT_TRUE(system->append(bodies.system, random_directions(bodies, 3, {}, 100 + seed), nullptr));
        answers.push_back(solved(*system));
      }
    }
    for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(answers[k], answers[k + 4]) << seed << " " << k;
  }
}

TEST(Capacitance, OfAStepDoesNotDependOnEarlierSteps) {
  for (const int directions_before : {80, 10}) {
    expect_that_steps_are_independent(Bodies(8, 30), directions_before);
    expect_that_steps_are_independent(Bodies(1, 240, 50), directions_before);
  }
}

// Directions that are set again as they were have the same bits, and others have their own system.
TEST(Capacitance, OfABodyAloneIsMadeAgainWhereSomethingChanged) {
  const Bodies bodies(1, 240, 50);
  for (const int count : {10, 60}) {
    const Motions motions(bodies, 1);
    const Directions wanted = sorted(random_directions(bodies, count, {}, 8));
    Capacitance system;
    system.add_motions(&motions.added);
    system.begin_step(bodies.system, bodies.parts);
    ASSERT_TRUE(system.set(bodies.system, wanted, nullptr));
    const Eigen::VectorXf first = solved(system);
    ASSERT_TRUE(system.set(bodies.system, wanted, nullptr));
    EXPECT_EQ(solved(system), first);
    ASSERT_TRUE(system.append(bodies.system, {}, nullptr));
    EXPECT_EQ(solved(system), first);
    const Directions others = sorted(random_directions(bodies, count, {}, 9));
    ASSERT_TRUE(system.set(bodies.system, others, nullptr));
    expect_dense(bodies, system, &motions);
    ASSERT_TRUE(system.set(bodies.system, Directions(others.begin(), others.end() - 3), nullptr));
    expect_dense(bodies, system, &motions);
    const Motions moved(bodies, 2);
    system.add_motions(&moved.added);
    ASSERT_TRUE(system.set(bodies.system, wanted, nullptr));
    expect_dense(bodies, system, &moved);
  }
}

// The dense factor of one list of directions, which keeps what belongs to the first directions and grows at its end.
struct DenseFactor {
  BlockFactor::RowMatrix lower;
  Eigen::Index factored = 0;

  void extend(const Bodies& bodies, const Capacitance& system, Eigen::Index kept) {
    const Directions& all = system.directions();
    const auto n = std::ssize(all), first = std::min(factored, kept), more = n - first;
    InverseEntries entries;
    std::vector<std::int32_t> vertices;
    for (const StiffDirection& s : all) vertices.push_back(s.stencil.vertex[0]);
    entries.learn(bodies.system.factor, vertices, nullptr);
    lower.conservativeResize(n, n);
    for (Eigen::Index i = first; i < n; ++i) {
      for (Eigen::Index j = 0; j <= i; ++j)
        lower(i, j) = static_cast<float>(all[i].axis.dot(all[j].axis)) * entries.entry(vertices[i], vertices[j]);
      lower(i, i) += static_cast<float>(1 / all[i].stiffness);
    }
    auto below = lower.block(first, 0, more, first);
    auto corner = lower.block(first, first, more, more);
    if (first > 0) {
      auto right = below.transpose();
      lower.topLeftCorner(first, first).triangularView<Eigen::Lower>().solveInPlace(right);
      corner.selfadjointView<Eigen::Lower>().rankUpdate(below, -1);
    }
    const Eigen::LLT<Eigen::Ref<BlockFactor::RowMatrix>> done(corner);
    factored = n;
  }
  Eigen::VectorXf solve(Eigen::VectorXf answer) const {
    lower.triangularView<Eigen::Lower>().solveInPlace(answer);
    lower.triangularView<Eigen::Lower>().transpose().solveInPlace(answer);
    return answer;
  }
};

TEST(Capacitance, OfOnePartHasTheBitsOfADenseFactor) {
  const Bodies bodies(1, 80);
  const Directions all = sorted(random_directions(bodies, 60, {}, 9));
  Capacitance system;
  system.begin_step(bodies.system, bodies.parts);
  DenseFactor dense;
  const auto expect_same = [&](Eigen::Index kept) {
    dense.extend(bodies, system, kept);
    Eigen::VectorXf right(std::ssize(system.directions()));
    for (Eigen::Index i = 0; i < right.size(); ++i) right[i] = std::sin(1.0f + 2.0f * static_cast<float>(i));
    EXPECT_EQ(solved(system), dense.solve(right));
  };
  ASSERT_TRUE(system.set(bodies.system, Directions(all.begin(), all.begin() + 120), nullptr));
  expect_same(0);
  ASSERT_TRUE(system.append(bodies.system, Directions(all.begin() + 120, all.begin() + 140), nullptr));
  expect_same(120);
  Directions fewer = all;
  fewer.erase(fewer.begin() + 90, fewer.begin() + 96);
  ASSERT_TRUE(system.set(bodies.system, fewer, nullptr));
  expect_same(90);
}

TEST(BlockPattern, OfAChainOfPartsHasWorkThatGrowsWithItsLength) {
  const auto operations = [](int links) {
    std::vector<GroupKey> keys;
    for (int k = 0; k < links; ++k) {
      keys.push_back({k, k + 1, -1, -1});
      keys.push_back({k, -1, -1, -1});
    }
    return factor_operations(keys, std::vector<Eigen::Index>(keys.size(), 30));
  };
  EXPECT_LT(operations(400), 2.1 * operations(200));
}

TEST(BlockPattern, HasABlockWhereAnEarlierColumnActs) {
  // A ring of four parts: what is left when the first pair has gone is a triangle.
  const std::vector<GroupKey> ring = {{0, 1, -1, -1}, {1, 2, -1, -1}, {2, 3, -1, -1}, {0, 3, -1, -1}};
  const std::vector<std::vector<int>> below = {{1, 3}, {2, 3}, {3}, {}};
  EXPECT_EQ(blocks_below(ring), below);
}

}  // namespace capacitance_test
}  // namespace supple
