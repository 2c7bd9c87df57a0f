// Tests that the iterations of a step go on where the body is far from where they lead, and only there.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/threads.h"
#include "baselines/reference.h"
#include "sim/solver/further_iterations.h"
#include "sim/solver/step.h"
#include "support/contact_scene.h"

namespace supple {
namespace further_iterations_test {

using test::ContactScene;
using test::cube;
using test::shape_of;

const Collider ground{"ground", shape_of(HalfSpace{Vec3::UnitY(), 0}), 0, 0.5};

// A stiff cube that is thrown at the ground with spin: its impacts turn it.
struct Throw {
  ContactScene scene;

  // turn: how fast it spins about the vertical [1/s].
  explicit Throw(double turn = 1, const BodyDescription& body = cube(4, Corotated{3e5, 6e5}))
      : scene{body, {ground}, Vec3(0, 0.3, 0)} {
    scene.inputs.gravity = Vec3(0, -9.81, 0);
    scene.inputs.solver.newton = false;  // which would finish what is far even then
    for (int v = 0; v < scene.model.vertices; ++v) {
      const Vec3 arm = Vec3(scene.state.x.row(v).transpose()) - Vec3(0, 0.3, 0);
      scene.state.v.row(v) = (Vec3(2, -3, 0) + Vec3(1, turn, -12).cross(arm)).transpose();
    }
  }

  // Makes the step from a state with other settings, and returns where it leads.
  State step_with(const SolverSettings& solver, const State& from, OpenWorkspace& w) const {
    StepInputs inputs = scene.inputs;
    inputs.solver = solver;
    State state = from;
    step(scene.model, inputs, state, w);
    return state;
  }
};

TEST(FurtherIterations, BringABodyThatIsFarNearer) {
  int longer = 0, usual = 0;
  double logarithms = 0;
  for (const double turn : {0, 1, 3, 5}) {
    Throw thrown(turn);
    ContactScene& scene = thrown.scene;
    SolverSettings ten = scene.inputs.solver;
    ten.rounds = 1;
    Reference reference(scene.model);
    OpenWorkspace other, scratch;
    for (int frame = 0; frame < 40; ++frame) {
      SCOPED_TRACE(frame);
      const State before = scene.state;
      const StepReport& report = scene.step();
      ASSERT_FALSE(report.failed);
      const State at_ten = thrown.step_with(ten, before, other);
      if (report.iterations <= 10) {
        ++usual;
        EXPECT_EQ(scene.state.x, at_ten.x);
        continue;
      }
      ++longer;
      EXPECT_LE(report.iterations, 30);
      // The last direction is found after the iteration by which the step was judged.
      if (report.iterations < 30) {
        EXPECT_LT(report.motion_estimate, 0.015);
      }
      const double now = reference.step_errors(scene.model, scene.inputs, before, scene.state, scratch).motion,
                   then = reference.step_errors(scene.model, scene.inputs, before, at_ten, scratch).motion;
      EXPECT_GT(then, 0.003) << "ten iterations were enough";
      logarithms += std::log(std::max(now, 1e-9) / then);
    }
  }
  EXPECT_GT(usual, 80);
  ASSERT_GT(longer, 5);
  EXPECT_LT(std::exp(logarithms / longer), 0.3) << "as a geometric mean over " << longer << " steps";
}

// Returns the most iterations that a step of a throw makes, after a change to its settings.
template <class Change>
int most_iterations(const Change& change, const BodyDescription& body = cube(4, Corotated{3e5, 6e5})) {
  Throw thrown(1, body);
  change(thrown.scene.inputs.solver);
  int iterations = 0;
  for (int frame = 0; frame < 12; ++frame) iterations = std::max(iterations, thrown.scene.step().iterations);
  return iterations;
}

void keep(SolverSettings&) {}

// The paper's method makes the paper's iterations, and a target and a budget say themselves when a step ends.
TEST(FurtherIterations, AreNotForOneLevelTargetsBudgetsOrASingleRound) {
  EXPECT_GT(most_iterations(keep), 10);
  EXPECT_EQ(most_iterations([](SolverSettings& solver) { solver.levels = 1; }), 10);
  EXPECT_EQ(most_iterations([](SolverSettings& solver) { solver.target_error = 1e-12; }), 10);
  EXPECT_EQ(most_iterations([](SolverSettings& solver) { solver.budget_ms = 1e6; }), 10);
  EXPECT_EQ(most_iterations([](SolverSettings& solver) { solver.line_search = LineSearch::none; }), 10);
  EXPECT_EQ(most_iterations([](SolverSettings& solver) { solver.rounds = 1; }), 10);
}

TEST(FurtherIterations, AreNotForMidpoint) {
  BodyDescription body = cube(4, Corotated{3e5, 6e5});
  body.integrator = Integrator::implicit_midpoint;
  EXPECT_EQ(most_iterations(keep, body), 10);
}

// Steps of soft cubes are far first, and then gain energy: what they have gone on by counts to the rounds.
TEST(FurtherIterations, AreNoMoreThanTheRoundsAllow) {
  int all_rounds = 0;
  for (const auto& [young, loads] : {std::pair(1e3, 1), std::pair(3e3, 10), std::pair(3e3, 100), std::pair(1e4, 1)}) {
    Throw thrown(1, cube(4, NeoHookean{young, young}));
    thrown.scene.inputs.gravity *= loads;
    thrown.scene.inputs.solver.rounds = 2;
    thrown.scene.inputs.solver.iterations = 3;
    for (int frame = 0; frame < 40; ++frame) {
      const int iterations = thrown.scene.step().iterations;
      EXPECT_TRUE(iterations <= 6 || iterations == 9) << iterations;  // 9: another search began where the cube was
      all_rounds += iterations == 6 ? 1 : 0;
    }
  }
  EXPECT_GT(all_rounds, 10);
}

// Turned copies of a body whose material is loose at rest would part where one copy goes on and another does not.
TEST(FurtherIterations, AreNotForMaterialsThatAreLooseAtRest) {
  Throw thrown(1, cube(4, StrainLimiting{6e5, 0.95, 1.05}));
  double farthest = 0;
  for (int frame = 0; frame < 12; ++frame) {
    const StepReport& report = thrown.scene.step();
    EXPECT_LE(report.iterations, 10);
    farthest = std::max(farthest, report.motion_estimate);
  }
  EXPECT_GT(farthest, 0.03) << "no step was far";
}

TEST(FurtherIterations, GiveTheSameBitsOnAnyNumberOfThreads) {
  const BodyDescription body = cube(12, Corotated{3e5, 6e5});  // whose elements are shared by threads
  Throw one(1, body), two(1, body);
  Threads threads(2);
  two.scene.w.threads = &threads;
  int most = 0;
  for (int frame = 0; frame < 12; ++frame) {
    most = std::max(most, one.scene.step().iterations);
    two.scene.step();
    ASSERT_EQ(one.scene.state.x, two.scene.state.x) << frame;
  }
  EXPECT_GT(most, 10);
}

// A step does not depend on what its workspace was used for before.
TEST(FurtherIterations, GiveTheSameBitsInAFreshWorkspace) {
  Throw thrown;
  int most = 0;
  for (int frame = 0; frame < 12; ++frame) {
    OpenWorkspace fresh;
    const State again = thrown.step_with(thrown.scene.inputs.solver, thrown.scene.state, fresh);
    most = std::max(most, thrown.scene.step().iterations);
    ASSERT_EQ(thrown.scene.state.x, again.x) << frame;
  }
  EXPECT_GT(most, 10);
}

}  // namespace further_iterations_test
}  // namespace supple
