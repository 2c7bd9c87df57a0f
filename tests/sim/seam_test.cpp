// Tests the energy of seams: gradients and second derivatives against differences, A against what is factored, all
// methods on one minimum, and models of several bodies.
#include "sim/model/seams.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "baselines/make_rule.h"
#include "baselines/system_matrix.h"
#include "sim/model/joined_model.h"
#include "sim/model/tangent_system.h"
#include "sim/solver/begin_step.h"
#include "sim/solver/hessian_matrix.h"
#include "support/bodies.h"
#include "support/objective_checks.h"

namespace supple {
namespace seam_test {

// Makes a sheet of 6 x 5 vertices whose left border is sewn to its right one, where gaps at the start are meant.
BodyDescription sewn_sheet(Integrator integrator = Integrator::backward_euler) {
  BodyDescription body = test::sheet({0.3, 0.2}, {5, 4}, {test::all_membranes()[0], 0.02});
  body.precision = Precision::double_precision;
  body.integrator = integrator;
  body.seams = {{{0, 5, 5}, {1, -1, 0}, {-0.25, 0.01, 0}},
                {{6, 5, 11}, {1, -0.3, -0.7}, {-0.28, 0, 0.02}},
                {{18, 17, 23}, {1, -0.6, -0.4}, {-0.3, 0.01, 0.01}}};
  return body;
}

BodyDescription held_and_damped(BodyDescription body) {
  body.handles.push_back({"edge", {0, 6, 12}});
  body.damping = 0.01;
  return body;
}

// Returns inputs for which the seams are half closed at the end of a step.
StepInputs half_closed(const Model& model) {
  StepInputs inputs = test::still_inputs(model);
  inputs.middle_targets = inputs.targets;
  inputs.seams.assign(model.parts.size(), {0.5, 0.6});
  return inputs;
}

TEST(Seams, TheirObjectiveHasItsGradientAndItsDifferences) {
  for (const Integrator integrator : {Integrator::backward_euler, Integrator::implicit_midpoint}) {
    BodyDescription body = sewn_sheet(integrator);
    test::expect_derivative_of_objective(body, "free");
    test::expect_derivative_of_objective(held_and_damped(body), "held and damped");
    body.curved = true;
    test::expect_derivative_of_objective(body, "curved at rest");
  }
}

TEST(Seams, TheirSecondDerivativeIsInTheHessian) {
  for (const Integrator integrator : {Integrator::backward_euler, Integrator::implicit_midpoint}) {
    const Model model = build_model(held_and_damped(sewn_sheet(integrator)));
    const StepInputs inputs = half_closed(model);
    OpenWorkspace w;
    w.prepare(model, {});
    const State state = rest_state(model);
    begin_step(model, inputs, state, w);
    w.current.x.topRows(model.free) = test::shaken(w.current.x, 0.005, 3).topRows(model.free);
    HessianMatrix hessian(model);
    hessian.assemble(model, w, false);
    const Positions way = Positions::Random(model.free, 3);
    Positions product(model.free, 3);
    hessian.multiply(way.data(), product.data());
    const auto gradient_at = [&](double step) {
      w.trial.x = w.current.x;
      w.trial.x.topRows(model.free) += step * way;
      evaluate(model, w, w.trial, Wanted::gradient);
      return w.trial.gradient;
    };
    const Positions found = (gradient_at(1e-7) - gradient_at(-1e-7)) / 2e-7;
    EXPECT_LT((product - found).norm(), 1e-5 * found.norm());
  }
}

TEST(Seams, AreInTheMatrixThatIsFactoredAndInTheOneThatFollowsTheBody) {
  const Model model = build_model(held_and_damped(sewn_sheet()));
  const SparseMatrix a = system_matrix_of(model);
  BodyDescription open = held_and_damped(sewn_sheet());
  open.seams.clear();
  EXPECT_GT(model.matrix.norm(), 2 * build_model(open).matrix.norm());
  const Positions b = Positions::Random(model.free, 3);
  Positions x(model.free, 3);
  AlignedVector<double> scratch;
  model.factor.solve(b.data(), x.data(), scratch);
  EXPECT_LT((a * x - b).norm(), 1e-12 * b.norm());
  TangentSystem tangent;
  ASSERT_TRUE(tangent.make(model, model.rest, {.tangent = 1, .constant = 0}, nullptr));
  const Eigen::MatrixXd followed = Eigen::MatrixXd(tangent.system().matrix);
  const SeamPair& pair = model.seams.pairs[1];
  const auto [low, high] = std::minmax(pair.vertex[1], pair.vertex[2]);
  ASSERT_LT(high, model.free);
  EXPECT_GT(followed(high, low), 0.1 * pair.stiffness);
  for (int v = 0; v < model.free; ++v) EXPECT_EQ(followed(v, v), tangent.system().diagonal[v]);
}

// Cloth has many minima, and methods need not end in the same one: what each of them leaves of the gradient tells
// whether it knows the seams.
TEST(Seams, AllMethodsReachAMinimum) {
  for (const Integrator integrator : {Integrator::backward_euler, Integrator::implicit_midpoint}) {
    const Model model = build_model(held_and_damped(sewn_sheet(integrator)));
    StepInputs inputs = half_closed(model);
    inputs.gravity.setZero();
    const State before = rest_state(model);
    const auto gradient_at = [&](const Positions& x) {
      OpenWorkspace w;
      w.prepare(model, {});
      begin_step(model, inputs, before, w);
      w.current.x.topRows(model.free) = x.topRows(model.free);
      evaluate(model, w, w.current, Wanted::gradient);
      return w.current.gradient.norm();
    };
    for (const Method& method : {Method::newton, Method::quasi_newton, Method::vertex_block_descent}) {
      const auto rule = make_rule(method, model);
      StepInputs own = inputs;
      own.solver = settings_of(method, own.solver);
      own.solver.iterations = 3000;
      State after = before;
      OpenWorkspace w;
      EXPECT_FALSE(step(model, own, after, w, *rule).failed) << name_of(method);
      EXPECT_GT((after.x - before.x).cwiseAbs().maxCoeff(), 0.01) << name_of(method);
      EXPECT_LT(gradient_at(after.x), 1e-4 * gradient_at(before.x)) << name_of(method);
    }
  }
}

TEST(Seams, OfSeveralBodiesCloseEachAtItsOwnTime) {
  const Model one = build_model(sewn_sheet()), joined = join({&one, &one});
  StepInputs inputs = half_closed(joined);
  inputs.seams = {{1, 1}, {0.25, 0.25}};
  ASSERT_EQ(joined.seams.pairs.size(), 6u);
  Positions gaps;
  open_gaps(joined, inputs.seams, &SeamOpening::end, gaps);
  EXPECT_EQ(gaps.topRows(3), 4 * gaps.bottomRows(3));
  double sum = 0;
  for (std::size_t p = 0; p < 2; ++p) {
    Positions own;
    open_gaps(one, {inputs.seams[p]}, &SeamOpening::end, own);
    sum += seam_energy(one, own, one.rest);
    EXPECT_EQ(joined_by_seams(joined, joined.parts[p]), joined_by_seams(one.seams.pairs)) << p;
  }
  EXPECT_GT(sum, 0);
  EXPECT_NEAR(seam_energy(joined, gaps, joined.rest), sum, 1e-12 * sum);
}

TEST(Seams, CloseSmoothlyWithinTheirTime) {
  EXPECT_EQ(seam_opening(0, 0.5), 1);
  EXPECT_EQ(seam_opening(0.5, 0.5), 0);
  EXPECT_EQ(seam_opening(3, 0.5), 0);
  EXPECT_DOUBLE_EQ(seam_opening(0.25, 0.5), 0.5);
  for (double t = 0.01; t < 0.5; t += 0.01) EXPECT_LT(seam_opening(t, 0.5), seam_opening(t - 0.01, 0.5));
  EXPECT_LT(1 - seam_opening(0.005, 0.5), 1e-3);
}

}  // namespace seam_test
}  // namespace supple
