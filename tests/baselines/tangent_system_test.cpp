// Tests the matrix that follows the body: against the traces of the projected Hessian's blocks, under rotations, and
// its bits on several threads.
#include "sim/model/tangent_system.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "sim/solver/hessian_matrix.h"
#include "support/bodies.h"

namespace supple {
namespace tangent_system_test {

using test::Held;

Eigen::MatrixXd full(const Eigen::SparseMatrix<double>& lower) {
  return Eigen::MatrixXd(lower).selfadjointView<Eigen::Lower>();
}

constexpr TangentShares all_tangent{1, 0, 0};

// A third of the trace of each 3 x 3 block of the Hessian whose element parts are projected, at x.
Eigen::MatrixXd traces(const Model& model, const Positions& x) {
  ElementMatrices elements;
  element_matrices(model, nullptr, x, true, elements);
  HessianMatrix hessian(model);
  hessian.assemble(model, elements, {}, x);
  const Eigen::MatrixXd all = full(hessian.matrix());
  Eigen::MatrixXd result(model.free, model.free);
  for (int i = 0; i < model.free; ++i) {
    for (int j = 0; j < model.free; ++j) result(i, j) = all.block<3, 3>(3 * i, 3 * j).trace() / 3;
  }
  return result;
}

void expect_traces(const BodyDescription& body, double amount, const std::string& what) {
  const Model model = build_model(body);
  const Positions x = test::shaken(model.rest, amount, 5);
  TangentSystem tangent;
  tangent.make(model, x, all_tangent, nullptr);
  const Eigen::MatrixXd expected = traces(model, x);
  EXPECT_LT((full(tangent.system().matrix) - expected).norm(), 1e-11 * expected.norm()) << what;
}

TEST(TangentSystem, HasAThirdOfTheTracesOfTheProjectedHessian) {
  for (const Material& material : test::all_materials()) {
    for (const double amount : {0.0, 0.01, 0.1}) {  // up to inverted elements
      const BodyDescription body = test::bar(material, Held::hard_end);
      expect_traces(body, amount, std::string(name_of(material)));
    }
  }
}

TEST(TangentSystem, HasThemWithFibresSpringsHandlesDampingAndMidpoint) {
  BodyDescription body = test::bar(NeoHookean{1e4, 4e4}, Held::spring_end);
  Fibre fibre{3e4, {0.6, 0.8, 0}};
  body.fibres.assign(body.materials.size(), fibre);
  body.springs = {{0, 7, 0.05, 800}, {3, 12, 0.5, 300}};
  expect_traces(body, 0.02, "backward Euler");
  body.integrator = Integrator::implicit_midpoint;
  body.damping = 0.01;
  expect_traces(body, 0.02, "midpoint, damped");
  body.handles[0].stiffness = 0;
  expect_traces(body, 0.02, "hard handle");
  expect_traces(test::spring_net(4), 0.02, "net");
}

TEST(TangentSystem, HoldsInertiaAndDoesNotSeeTranslations) {
  BodyDescription body = test::bar(Corotated{1e4, 4e4}, Held::hard_end);
  body.damping = 0.02;
  const Model model = build_model(body);
  TangentSystem tangent;
  tangent.make(model, test::shaken(model.rest, 0.02, 1), {}, nullptr);
  Eigen::VectorXd sums = full(tangent.system().matrix).rowwise().sum();
  for (const System::Coupling& c : tangent.system().couplings) sums[c.free] += c.value;
  for (int v = 0; v < model.free; ++v) {
    const double inertia = model.mass[v] / (model.time_step * model.time_step);
    EXPECT_NEAR(sums[v], inertia, 1e-10 * model.diagonal[v]);
    EXPECT_EQ(tangent.system().diagonal[v], tangent.system().matrix.coeff(v, v));
  }
}

TEST(TangentSystem, DoesNotChangeWhenTheBodyTurns) {
  const Mat3 turn = Eigen::AngleAxisd(2.1, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
  for (const Material& material : test::all_materials()) {
    const Model model = build_model(test::bar(material, Held::nothing));
    const Positions x = test::shaken(model.rest, 0.015, 2);
    TangentSystem straight, turned;
    straight.make(model, x, all_tangent, nullptr);
    turned.make(model, x * turn.transpose(), all_tangent, nullptr);
    const Eigen::MatrixXd expected = full(straight.system().matrix);
    EXPECT_LT((full(turned.system().matrix) - expected).norm(), 1e-9 * expected.norm()) << name_of(material);
  }
}

TEST(TangentSystem, ResistsAStretchAlongOneAxisByAtLeastAShareOfTheHessian) {
  // At rest a third of the trace is (4 mu + lambda) / 3, and what a stretch along one axis meets 2 mu + lambda.
  const double mu = 1e4, lambda = 4e4, axial = 0.9;
  const Model model = build_model(test::bar(Corotated{mu, lambda}, Held::nothing));
  TangentSystem low, high;
  low.make(model, model.rest, all_tangent, nullptr);
  high.make(model, model.rest, {1, 0, axial}, nullptr);
  for (int v = 0; v < model.free; ++v) {
    const double inertia = model.mass[v] / (model.time_step * model.time_step);
    EXPECT_NEAR((high.system().diagonal[v] - inertia) / (low.system().diagonal[v] - inertia),
                3 * axial * (2 * mu + lambda) / (4 * mu + lambda), 1e-9);
  }
}

TEST(TangentSystem, TellsHowFarTheStiffnessHasDeparted) {
  const Model model = build_model(test::bar(Polynomial{1e4}, Held::nothing, Precision::single_precision, 2));
  TangentSystem tangent;
  const Positions x = model.rest * 1.1;
  tangent.make(model, x, all_tangent, nullptr);
  const Mat3 turn = Eigen::AngleAxisd(1.3, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  EXPECT_LT(tangent.departure(model, x * turn.transpose()), 1e-10);
  // Stretched by s alike along all axes, e = s - 1: h_bb and flips are 12 mu e^2, twists 4 mu e^3 / s.
  const auto kappa = [](double s) { return 24 * std::pow(s - 1, 2) + 4 * std::pow(s - 1, 3) / s; };
  EXPECT_NEAR(tangent.departure(model, model.rest * 1.2), kappa(1.2) / kappa(1.1) - 1, 1e-9);
  // At rest it has none; the share of A is what a change counts against.
  tangent.make(model, model.rest, {0.8, 0.2, 0}, nullptr);
  EXPECT_LT(tangent.departure(model, model.rest), 1e-12);
  EXPECT_LT(tangent.departure(model, model.rest * 1.01), 0.02);
  EXPECT_GT(tangent.departure(model, model.rest * 1.3), 1);
}

TEST(TangentSystem, IsTheSameMatrixAsAWhereItsShareIsZero) {
  const Model model = build_model(test::bar(Corotated{1e4, 4e4}, Held::hard_end));
  TangentSystem tangent;
  tangent.make(model, test::shaken(model.rest, 0.02, 1), {0, 1, 0}, nullptr);
  EXPECT_EQ(full(tangent.system().matrix), full(model.matrix));
  Positions b = test::shaken(Positions::Zero(model.free, 3), 1, 3), x = b, y = b;
  AlignedVector<double> scratch;
  model.factor.solve(b.data(), x.data(), scratch);
  tangent.system().factor.solve(b.data(), y.data(), scratch);
  EXPECT_EQ(x, y);
}

TEST(TangentSystem, HasTheSameBitsOnAnyNumberOfThreadsAndAfterOtherMatrices) {
  const Model model = build_model(test::bar(NeoHookean{1e4, 4e4}, Held::hard_end, Precision::single_precision, 6));
  const Positions x = test::shaken(model.rest, 0.005, 1);
  TangentSystem alone;
  alone.make(model, x, {}, nullptr);
  const Positions b = test::shaken(Positions::Zero(model.free, 3), 1, 3);
  AlignedVector<double> scratch;
  Positions expected = b, found = b;
  alone.system().factor.solve(b.data(), expected.data(), scratch);
  for (const int count : {1, 2, 4}) {
    Threads threads(count);
    TangentSystem other;
    other.make(model, model.rest, {}, &threads);
    const std::uint64_t before = other.system().id;
    other.make(model, x, {}, &threads);
    EXPECT_NE(other.system().id, before);
    other.system().factor.solve(b.data(), found.data(), scratch);
    EXPECT_EQ(found, expected);
    const std::uint64_t made = other.system().id;
    other.make(model, x, {}, &threads);  // it is there already
    EXPECT_EQ(other.system().id, made);
  }
}

}  // namespace tangent_system_test
}  // namespace supple
