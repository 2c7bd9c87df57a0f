// Tests that hard steps are finished by Newton's method, and that others are not touched by it.
#include "sim/solver/newton_finish.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "base/threads.h"
#include "baselines/make_rule.h"
#include "baselines/reference.h"
#include "sim/solver/first_iterate.h"
#include "sim/solver/hessian_matrix.h"
#include "support/contact_scene.h"

namespace supple {
namespace newton_finish_test {

using test::cube;
using test::shape_of;

// A plate that turns ten times a second hits a cube at rest, whose elements are pressed flat: they become many times as
// stiff as A says.
struct Impact {
  test::ContactScene scene;
  double angle = -1.4;

  explicit Impact(int cells)
      : scene(cube(cells, NeoHookean::from(Lame::from_young(1e5, 0.4))),
              {{"plate", shape_of(Box{Vec3(0.025, 0.3, 0.3), 0})}}, Vec3(0, 0, 0.2)) {
    scene.inputs.gravity.setZero();
    scene.inputs.solver.levels = 1;  // with which more steps are hard
  }
  void move() {
    ColliderMotion& motion = scene.inputs.collider_motions[0];
    motion.start = Eigen::AngleAxisd(angle, Vec3::UnitY());
    motion.end = Eigen::AngleAxisd(angle += 2.0944, Vec3::UnitY());
  }
};

TEST(NewtonFinish, BringsHardStepsToTheirMinimum) {
  Impact impact(6);
  test::ContactScene& scene = impact.scene;
  int hard = 0;
  for (int step = 0; step < 20; ++step) {
    SCOPED_TRACE(step);
    impact.move();
    const State before = scene.state;
    State without = before;
    OpenWorkspace other;
    StepInputs plain = scene.inputs;
    plain.solver.newton = false;
    ASSERT_FALSE(supple::step(scene.model, plain, without, other).failed);
    EXPECT_EQ(other.report.newton_iterations, 0);

    const StepReport& report = scene.step();
    ASSERT_FALSE(report.failed);
    if (report.newton_iterations == 0) continue;
    ++hard;
    EXPECT_LT(report.newton_iterations, 20);
    EXPECT_LT(report.error_estimate, 1e-3);
    Reference reference(scene.model);
    const double with = reference.step_error(scene.model, scene.inputs, before, scene.state, other).value_or(0);
    EXPECT_LT(with, 1e-3);
    // Where contacts come and go, neither is nearer than this.
    constexpr double as_near = 1e-5;
    EXPECT_LT(with,
              std::max(as_near, reference.step_error(scene.model, scene.inputs, before, without, other).value_or(0)));
  }
  EXPECT_GT(hard, 0);
}

const Collider ground{"ground", shape_of(HalfSpace{Vec3::UnitY(), 0}), 0, 0.3};

TEST(NewtonFinish, LeavesEasyStepsAlone) {
  test::ContactScene scene(cube(3), {ground}, Vec3(0, 0.12, 0)), without(cube(3), {ground}, Vec3(0, 0.12, 0));
  without.inputs.solver.newton = false;
  for (int step = 0; step < 12; ++step) {
    EXPECT_EQ(scene.step().newton_iterations, 0);
    without.step();
    ASSERT_EQ(scene.state.x, without.state.x) << step;
  }
}

// A rule that does not estimate what is left before its first iteration had been taken to be at the minimum there.
TEST(NewtonFinish, IsNotEndedByATargetErrorBeforeItHasBegun) {
  Impact impact(6);
  impact.scene.inputs.solver.target_error = 1e-5;
  int hard = 0;
  for (int step = 0; step < 20; ++step) {
    impact.move();
    const StepReport& report = impact.scene.step();
    hard += report.newton_iterations;
    EXPECT_LT(report.error_estimate, 0.1) << step;
  }
  EXPECT_GT(hard, 0);

  const Model model = build_model(test::bar(NeoHookean{1e4, 4e4}, test::Held::hard_end));
  StepInputs inputs = test::still_inputs(model);
  inputs.solver.target_error = 1e-5;
  State state = rest_state(model);
  OpenWorkspace w;
  const auto newton = make_rule(Method::newton, model);
  EXPECT_GT(step(model, inputs, state, w, *newton).iterations, 1);
}

TEST(NewtonFinish, HasTheSameBitsForAnyNumberOfThreads) {
  Impact one(6), two(6);
  Threads threads(2);
  two.scene.w.threads = &threads;
  int hard = 0;
  for (int step = 0; step < 20; ++step) {
    one.move();
    two.move();
    hard += one.scene.step().newton_iterations;
    two.scene.step();
    ASSERT_EQ(one.scene.state.x, two.scene.state.x) << step;
    ASSERT_EQ(one.scene.state.v, two.scene.state.v) << step;
  }
  EXPECT_GT(hard, 0);
}

TEST(NewtonFinish, IsNotForBudgetsSpringsOrVeryLargeBodies) {
  const Model model = build_model(cube(3));
  StepInputs inputs = test::still_inputs(model);
  EXPECT_TRUE(may_finish_by_newton(model, inputs));
  inputs.solver.rounds = 1;
  EXPECT_FALSE(may_finish_by_newton(model, inputs));
  inputs.solver.rounds = 2;
  inputs.solver.budget_ms = 5;
  EXPECT_FALSE(may_finish_by_newton(model, inputs));
  inputs.solver.budget_ms = 0;
  EXPECT_TRUE(may_finish_by_newton(model, inputs));
  const Model large = build_model(cube(24));
  EXPECT_GT(newton_cost(large), 200);
  EXPECT_FALSE(may_finish_by_newton(large, inputs));
}

// The direction is that of a dense solve, with the planes that it would lead through held as if they were touched.
TEST(NewtonSystem, SolvesWithTheHessianAndThePlanesAhead) {
  test::ContactScene scene(cube(2, NeoHookean{3e4, 6e4}), {ground}, Vec3(0, 0.101, 0));
  scene.state.v.col(1).setConstant(-1);
  OpenWorkspace& w = scene.w;
  w.prepare(scene.model, scene.inputs.solver);
  begin_step(scene.model, scene.inputs, scene.state, w);
  w.current.x = scene.state.x + 1e-3 * test::shaken(Positions::Zero(scene.model.vertices, 3), 1, 3);
  w.report.objective.clear();
  evaluate_start(scene.model, scene.inputs, w);
  ASSERT_FALSE(w.current.contacts.empty());
  const double slope = w.newton.direction(scene.model, scene.inputs, w);
  EXPECT_NEAR(slope, w.current.gradient.cwiseProduct(w.direction).sum(), 1e-12 * std::abs(slope));

  HessianMatrix hessian(scene.model);
  hessian.assemble(scene.model, w, true);
  Positions right = w.current.gradient;
  int ahead = 0;
  for (const Contact& contact : w.current.contacts) {
    const double here = gap(contact, w.current.x);
    const double there = here + contact.normal.dot(contact.stencil.of_free(w.direction));
    if (here < 0) continue;
    // A plane that was held stops the direction a little below itself, where its force is that of the elements.
    if (there >= 0) continue;
    ++ahead;
    EXPECT_GT(there, -1e-3);
    hessian.add_stiffness(contact.stencil, 2 * contact.stiffness * contact.normal * contact.normal.transpose());
    contact.stencil.spread(2 * contact.stiffness * here * contact.normal, right);
  }
  EXPECT_GT(ahead, 0);
  const Eigen::MatrixXd full = Eigen::MatrixXd(hessian.matrix()).selfadjointView<Eigen::Lower>();
  const Eigen::Map<const Eigen::VectorXd> r(right.data(), right.size()), d(w.direction.data(), w.direction.size());
  EXPECT_LT((full * d + r).norm(), 1e-9 * r.norm());
}

}  // namespace newton_finish_test
}  // namespace supple
