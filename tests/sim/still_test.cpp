// Tests that a step ends where nothing is left to go that anybody could see, and that only such a step does.
#include <gtest/gtest.h>

#include "baselines/reference.h"
#include "sim/model/motion_error.h"
#include "support/contact_scene.h"

namespace supple {
namespace still_test {

using test::ContactScene;
using test::cube;
using test::shape_of;

const Collider ground{"ground", shape_of(HalfSpace{Vec3::UnitY(), 0}), 0, 0.5};

// A cube that has been put down, and lies by now.
ContactScene lying_cube(double still) {
  ContactScene scene(cube(3), {ground}, Vec3(0, 0.1, 0));
  scene.inputs.gravity = Vec3(0, -9.81, 0);
  scene.inputs.solver.still = still;
  for (int frame = 0; frame < 90; ++frame) scene.step();
  return scene;
}

// Friction lets what lies slide by some 2e-6 sizes a step, and still steps follow that too.
TEST(Still, StepsOfABodyAtRestMakeHardlyAnyIterationsAndGoWhereAllLead) {
  ContactScene quick = lying_cube(1e-6), whole = lying_cube(0);
  int iterations = 0;
  for (int frame = 0; frame < 150; ++frame) {
    const StepReport& report = quick.step();
    EXPECT_EQ(report.stop_reason, StopReason::still);
    EXPECT_FALSE(is_unsolved(report));
    iterations += report.iterations;
    whole.step();
  }
  EXPECT_LE(iterations, 150);
  EXPECT_LT((quick.state.x - whole.state.x).cwiseAbs().maxCoeff(), 1e-5 * quick.model.size);
}

// The true error of motion of every step that ends so, while the cube comes to rest.
TEST(Still, LeavesLittleOfTheMotionOfEachStep) {
  ContactScene scene(cube(3), {ground}, Vec3(0, 0.13, 0));
  scene.inputs.gravity = Vec3(0, -9.81, 0);
  scene.inputs.solver.still = 1e-6;
  Reference reference(scene.model);
  OpenWorkspace scratch;
  int count = 0;
  for (int frame = 0; frame < 60; ++frame) {
    const State before = scene.state;
    if (scene.step().stop_reason != StopReason::still) continue;
    ++count;
    EXPECT_LT(reference.step_errors(scene.model, scene.inputs, before, scene.state, scratch).motion, 0.1) << frame;
  }
  EXPECT_GT(count, 20);
}

// A cube swells, falls, and lands. The way that is left is an estimate, right within a factor of 3 nearly always.
TEST(Still, EndsStepsThatHaveNoMoreThanThatToGo) {
  ContactScene scene(cube(3), {ground}, Vec3(0, 0.4, 0));
  scene.inputs.gravity = Vec3(0, -9.81, 0);
  scene.state.v = 0.2 * scene.state.x;
  OpenWorkspace other;
  int ended = 0, whole = 0;
  for (int frame = 0; frame < 30; ++frame) {
    StepInputs solved_inputs = scene.inputs;
    solved_inputs.solver.iterations = 200;
    State solved = scene.state;
    step(scene.model, solved_inputs, solved, other);
    scene.inputs.solver.still = 1e-6;
    const bool is_still = scene.step().stop_reason == StopReason::still;
    ++(is_still ? ended : whole);
    if (!is_still) continue;
    EXPECT_LT(way_in_sizes(scene.model, scene.state.x - solved.x), 3e-6) << frame;
  }
  EXPECT_GT(ended, 5);
  EXPECT_GT(whole, 5) << "those of the landing";
}

TEST(Still, IsNoReasonToStopForThePapersMethod) {
  ContactScene scene = lying_cube(1e-6);
  scene.inputs.solver.levels = 1;
  EXPECT_NE(scene.step().stop_reason, StopReason::still);
  scene.inputs.solver.levels = 2;
  scene.inputs.solver.still = 0;
  EXPECT_NE(scene.step().stop_reason, StopReason::still);
}

}  // namespace still_test
}  // namespace supple
