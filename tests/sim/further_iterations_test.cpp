// Tests that the iterations of a step go on where the body is far from where they lead, and only there.
#include <gtest/gtest.h>

#include <cmath>

#include "baselines/reference.h"
#include "sim/solver/further_iterations.h"
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
  explicit Throw(double turn = 1, const Material& material = Corotated{3e5, 6e5})
      : scene{cube(4, material), {ground}, Vec3(0, 0.3, 0)} {
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

// The paper's method makes the paper's iterations, and a target says itself what is far.
TEST(FurtherIterations, AreNotForOneLevelTargetsOrASingleRound) {
  Throw thrown;
  const auto most = [&](const auto& change) {
    Throw other;
    change(other.scene.inputs.solver);
    int iterations = 0;
    for (int frame = 0; frame < 12; ++frame) iterations = std::max(iterations, other.scene.step().iterations);
    return iterations;
  };
  EXPECT_GT(most([](SolverSettings&) {}), 10);
  EXPECT_EQ(most([](SolverSettings& solver) { solver.levels = 1; }), 10);
  EXPECT_EQ(most([](SolverSettings& solver) { solver.target_error = 1e-12; }), 10);
  EXPECT_EQ(most([](SolverSettings& solver) { solver.rounds = 1; }), 10);
  EXPECT_LE(most([](SolverSettings& solver) { solver.rounds = 2; }), 20);
}

// Turned copies of a body whose material is loose at rest would part where one copy goes on and another does not.
TEST(FurtherIterations, AreNotForMaterialsThatAreLooseAtRest) {
  Throw thrown(1, StrainLimiting{6e5, 0.95, 1.05});
  double farthest = 0;
  for (int frame = 0; frame < 12; ++frame) {
    const StepReport& report = thrown.scene.step();
    EXPECT_LE(report.iterations, 10);
    farthest = std::max(farthest, report.motion_estimate);
  }
  EXPECT_GT(farthest, 0.03) << "no step was far";
}

TEST(FurtherIterations, GiveTheSameBitsOnAnyNumberOfThreads) {
  Throw one, two;
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

}  // namespace further_iterations_test
}  // namespace supple
