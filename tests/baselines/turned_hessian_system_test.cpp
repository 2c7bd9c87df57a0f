// Tests the Hessian that turns with the body: against the assembled one, under rotations, for symmetry and momentum,
// and its bits on several threads.
#include "sim/model/turned_hessian_system.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "sim/model/vertex_rotations.h"
#include "sim/solver/hessian_matrix.h"
#include "support/bodies.h"

namespace supple {
namespace turned_hessian_system_test {

using test::bar;
using test::Held;

const Mat3 some_turn = Eigen::AngleAxisd(2.1, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();

Eigen::MatrixXd full(const Eigen::SparseMatrix<double>& lower) {
  return Eigen::MatrixXd(lower).selfadjointView<Eigen::Lower>();
}

// The Hessian at x with each element's part projected, mixed with a share of A.
Eigen::MatrixXd expected_matrix(const Model& model, const Positions& x, double share) {
  ElementMatrices elements;
  element_matrices(model, nullptr, x, true, elements);
  HessianMatrix hessian(model);
  hessian.assemble(model, elements, {}, x);
  const Eigen::MatrixXd a = full(model.matrix);
  Eigen::MatrixXd result = (1 - share) * full(hessian.matrix());
  for (int i = 0; i < model.free; ++i) {
    for (int j = 0; j < model.free; ++j) result.block<3, 3>(3 * i, 3 * j).diagonal().array() += share * a(i, j);
  }
  return result;
}

Positions some_forces(const Model& model, unsigned seed) {
  return test::shaken(Positions::Zero(model.free, 3), 1, seed);
}

Positions solution(const Model& model, TurnedHessianSystem& hessian, const Positions& r) {
  Positions z(model.free, 3);
  hessian.solve(model, r, z);
  return z;
}

TurnedHessianSystem made_at(const Model& model, const Positions& x) {
  TurnedHessianSystem hessian;
  EXPECT_TRUE(hessian.make(model, x, nullptr));
  hessian.turn_to(x, nullptr);
  return hessian;
}

double distance(const Positions& a, const Positions& b) { return (a - b).norm() / b.norm(); }

TEST(TurnedHessianSystem, SolvesWithTheProjectedHessianAndAShareOfA) {
  for (const Material& material : test::all_materials()) {
    const double share = std::holds_alternative<StrainLimiting>(material) ? 1 : 0.02;
    for (const Held held : {Held::hard_end, Held::spring_end}) {
      BodyDescription body = bar(material, held);
      body.damping = held == Held::spring_end ? 0.01 : 0;
      const Model model = build_model(body);
      const Positions x = test::shaken(model.rest, 0.02, 5), r = some_forces(model, 3);
      TurnedHessianSystem hessian = made_at(model, x);
      const Eigen::MatrixXd expected = expected_matrix(model, x, share);
      const Eigen::Map<const Eigen::VectorXd> b(r.data(), r.size());
      const Eigen::VectorXd exact = expected.ldlt().solve(b);
      const Positions z = solution(model, hessian, r);
      const Eigen::Map<const Eigen::VectorXd> found(z.data(), z.size());
      EXPECT_LT((found - exact).norm(), 1e-8 * exact.norm()) << name_of(material);
    }
  }
}

TEST(TurnedHessianSystem, KnowsFibresAndSpringsBesideTetrahedra) {
  BodyDescription body = bar(NeoHookean{1e4, 4e4}, Held::hard_end);
  body.fibres.assign(body.materials.size(), Fibre{3e4, {0.6, 0.8, 0}});
  body.springs = {{0, 7, 0.05, 800}, {3, 12, 0.5, 300}};
  const Model model = build_model(body);
  const Positions x = test::shaken(model.rest, 0.02, 5), r = some_forces(model, 3);
  TurnedHessianSystem hessian = made_at(model, x);
  // Where an element has both, a share of A has the fibres' part of A too; the matrix leaves that part out.
  const Eigen::MatrixXd hessian_alone = expected_matrix(model, x, 0);
  const Positions z = solution(model, hessian, r);
  const Eigen::Map<const Eigen::VectorXd> b(r.data(), r.size()), found(z.data(), z.size());
  const Eigen::VectorXd exact = hessian_alone.ldlt().solve(b);
  EXPECT_LT((found - exact).norm(), 0.1 * exact.norm());
}

TEST(TurnedHessianSystem, TurnsWithTheBody) {
  for (const Material& material : test::all_materials()) {
    const Model model = build_model(bar(material, Held::nothing));
    const Positions x = test::shaken(model.rest, 0.01, 2), r = some_forces(model, 4);
    TurnedHessianSystem hessian = made_at(model, x);
    const Positions straight = solution(model, hessian, r);
    const Positions turned_place = (x * some_turn.transpose()).rowwise() + Eigen::RowVector3d(3, -1, 2);
    hessian.turn_to(turned_place, nullptr);
    const Positions turned = solution(model, hessian, r * some_turn.transpose());
    EXPECT_LT(distance(turned, straight * some_turn.transpose()), 1e-9) << name_of(material);
    EXPECT_LT(hessian.departure(model, turned_place), 1e-9);
  }
}

TEST(TurnedHessianSystem, IsSymmetricAndMovesTheCentreOfMassAsNewtonSays) {
  const Model model = build_model(bar(NeoHookean{1e4, 4e4}, Held::nothing, Precision::single_precision, 2));
  TurnedHessianSystem hessian = made_at(model, model.rest);
  // Twisted, so that vertices turn in different ways.
  Positions twisted = model.rest;
  for (int v = 0; v < model.vertices; ++v) {
    const Vec3 p = model.rest.row(v);
    twisted.row(v) = (Eigen::AngleAxisd(4 * p.x(), Vec3::UnitX()) * p).transpose();
  }
  hessian.turn_to(twisted, nullptr);
  const Positions a = some_forces(model, 1), b = some_forces(model, 2);
  const Positions za = solution(model, hessian, a), zb = solution(model, hessian, b);
  EXPECT_NEAR(a.cwiseProduct(zb).sum(), b.cwiseProduct(za).sum(), 1e-5 * a.cwiseProduct(za).sum());
  EXPECT_GT(a.cwiseProduct(za).sum(), 0);
  Eigen::RowVector3d moved = Eigen::RowVector3d::Zero();
  for (int v = 0; v < model.free; ++v) moved += model.mass[v] * za.row(v);
  const Eigen::RowVector3d wanted = model.time_step * model.time_step * a.colwise().sum();
  EXPECT_LT((moved - wanted).norm(), 1e-12 * wanted.norm());
}

TEST(TurnedHessianSystem, HasTheSameBitsOnAnyNumberOfThreadsAndAfterOtherMatrices) {
  const Model model = build_model(bar(NeoHookean{1e4, 4e4}, Held::hard_end, Precision::single_precision, 6));
  const Positions x = test::shaken(model.rest, 0.005, 1), y = test::shaken(model.rest, 0.005, 7);
  const Positions r = some_forces(model, 3);
  TurnedHessianSystem alone;
  ASSERT_TRUE(alone.make(model, x, nullptr));
  alone.turn_to(y, nullptr);
  const Positions expected = solution(model, alone, r);
  for (const int count : {1, 2, 4}) {
    Threads threads(count);
    TurnedHessianSystem other;
    ASSERT_TRUE(other.make(model, model.rest, &threads));
    ASSERT_TRUE(other.make(model, x, &threads));
    other.turn_to(y, &threads);
    EXPECT_EQ(solution(model, other, r), expected);
    EXPECT_EQ(other.departure(model, y), alone.departure(model, y));
  }
  EXPECT_GT(alone.stored_numbers(), 9 * model.free / 2);
  EXPECT_GT(alone.renewal_cost(model), 20);
}

TEST(TurnedHessianSystem, IsRefusedWherePositionsAreNoNumbers) {
  const Model model = build_model(bar(NeoHookean{1e4, 4e4}, Held::hard_end));
  Positions x = model.rest;
  x(0, 1) = std::nan("");
  TurnedHessianSystem hessian;
  EXPECT_FALSE(hessian.make(model, x, nullptr));
  EXPECT_TRUE(hessian.make(model, model.rest, nullptr));
}

Mat3 rotation_at(const Rotations& rotations, int v) {
  Mat3 result;
  for (int i = 0; i < 9; ++i) result(i / 3, i % 3) = rotations[std::size_t(v) * 12 + i / 3 * 4 + i % 3];
  return result;
}

TEST(VertexRotations, AreThoseOfTheElementsAround) {
  const Model model = build_model(bar(NeoHookean{1e4, 4e4}, Held::hard_end, Precision::single_precision, 4));
  const VertexRotations finder(model);
  Rotations found;
  finder.find(model.rest * some_turn.transpose() * 1.7, nullptr, found);
  for (int v = 0; v < model.free; ++v) EXPECT_LT((rotation_at(found, v) - some_turn).norm(), 1e-12);
  // A twist turns each vertex by its place along the axis.
  Positions twisted = model.rest;
  for (int v = 0; v < model.vertices; ++v) {
    const Vec3 p = model.rest.row(v);
    twisted.row(v) = (Eigen::AngleAxisd(1.5 * p.x(), Vec3::UnitX()) * p).transpose();
  }
  finder.find(twisted, nullptr, found);
  for (int v = 0; v < model.free; ++v) {
    const Mat3 expected = Eigen::AngleAxisd(1.5 * model.rest(v, 0), Vec3::UnitX()).toRotationMatrix();
    EXPECT_LT((rotation_at(found, v) - expected).norm(), 0.2) << v;
  }
}

TEST(VertexRotations, TurnMultiplyAndTurnBack) {
  const Model model = build_model(bar(NeoHookean{1e4, 4e4}, Held::hard_end));
  const VertexRotations finder(model);
  Rotations first, back, second;
  finder.find(model.rest * some_turn.transpose(), nullptr, first);
  transpose(first, back);
  const Positions r = some_forces(model, 1);
  Positions there(model.free, 3), again(model.free, 3);
  turn_back(back, r, there);
  EXPECT_LT(distance(there, r * some_turn.transpose()), 1e-12);
  turn_back(first, there, again);
  EXPECT_LT(distance(again, r), 1e-12);
  turn_back(first, there, there);
  EXPECT_EQ(there, again);
  const Mat3 other_turn = Eigen::AngleAxisd(0.7, Vec3::UnitY()).toRotationMatrix();
  finder.find(model.rest * (other_turn * some_turn).transpose(), nullptr, second);
  multiply(second, back, second);
  for (int v = 0; v < model.free; ++v) EXPECT_LT((rotation_at(second, v) - other_turn).norm(), 1e-12);
}

}  // namespace turned_hessian_system_test
}  // namespace supple
