// Estimates of what a step leaves, on sequences of which it is known.
#include "sim/solver/error_estimate.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "baselines/reference.h"
#include "geometry/triangles/surface_thickness.h"
#include "sim/model/joined_model.h"
#include "sim/model/motion_error.h"
#include "support/contact_scene.h"

namespace supple {
namespace error_estimate_test {

// Follows iterations after each of which what is left, `over` times the decrement, is `ratio` of what was left before.
Decrements even_iterations(int count, double decrement, double over, double ratio) {
  Decrements decrements;
  for (int k = 0; k < count; ++k, decrement *= ratio) decrements.add(decrement, over * decrement * (1 - ratio));
  return decrements;
}

TEST(ErrorEstimate, IsExactWhereIterationsGainEvenly) {
  for (const double ratio : {1e-6, 0.1, 0.5, 0.84}) {
    for (const double over : {1.0, 3.0, 40.0}) {
      for (const int count : {1, 2, 4, 9}) {
        const double decrement = 5 * std::pow(ratio, count);
        EXPECT_NEAR(even_iterations(count, 5, over, ratio).left(decrement) / (over * decrement), 1, 1e-9)
            << ratio << ", " << over << ", " << count;
      }
    }
  }
}

TEST(ErrorEstimate, IsTheDecrementBeforeTheFirstIterationAndNeverLess) {
  EXPECT_EQ(Decrements().left(7), 7);
  EXPECT_EQ(even_iterations(5, 1e-3, 0.1, 0.5).left(7), 7);
  EXPECT_EQ(even_iterations(5, 1, 0, 0.5).left(0.03), 0.03) << "nothing was gained";
  EXPECT_EQ(even_iterations(5, 1, 3, 0.5).left(0), 0) << "the direction was too short to matter";
}

TEST(ErrorEstimate, ForgetsWhatIsFourIterationsOld) {
  Decrements decrements = even_iterations(20, 1e6, 1e3, 0.8);
  double decrement = 5;
  for (int k = 0; k < 4; ++k, decrement *= 0.25) decrements.add(decrement, 2 * decrement * 0.75);
  EXPECT_NEAR(decrements.left(decrement) / (2 * decrement), 1, 1e-9);
}

TEST(ErrorEstimate, StaysBoundedWhereDecrementsGrow) {
  Decrements decrements;
  for (const double decrement : {1.0, 2.0, 4.0}) decrements.add(decrement, 1);
  EXPECT_LE(decrements.left(8), 17) << "17/3 times what was gained since";
  EXPECT_GE(decrements.left(8), 17 / 3.0);
}

// Most of what such a step gains, it gains before its iterations, when the handle's motion is spread into the body.
TEST(ErrorEstimate, EndsAStepAsSoonAsItIsBelowTheTarget) {
  const Model model = build_model(test::bar(NeoHookean{2e4, 8e4}, test::Held::hard_end));
  StepInputs inputs = test::still_inputs(model);
  inputs.targets.col(0).array() += 0.02;
  inputs.solver.rounds = 1;
  const auto stepped = [&](double target, int iterations) {
    inputs.solver.target_error = target;
    inputs.solver.iterations = iterations;
    State state = rest_state(model);
    OpenWorkspace w;
    return step(model, inputs, state, w);
  };
  const auto worse = [](const StepReport& report) { return std::max(report.error_estimate, report.motion_estimate); };
  for (const double target : {1e-2, 1e-3, 1e-4}) {
    const StepReport report = stepped(target, 100);
    EXPECT_EQ(report.stop_reason, StopReason::target_error);
    EXPECT_LT(worse(report), target);
    ASSERT_GT(report.iterations, 0);
    EXPECT_GE(worse(stepped(0, report.iterations - 1)), target) << target;
  }
}

// The step of a body that lands or lies ends far above where it would have gone freely, deep in the ground. Equation 12
// counts from there.
TEST(ErrorEstimate, CountsFromThePredictionInContactToo) {
  test::ContactScene scene(test::cube(3), {{"ground", test::shape_of(HalfSpace{Vec3::UnitY(), 0})}}, Vec3(0, 0.13, 0));
  scene.state.v.rowwise() = Eigen::RowVector3d(0.2, -1, 0.1);
  scene.inputs.solver.iterations = 4;
  Reference reference(scene.model);
  OpenWorkspace scratch;
  int count = 0;
  double sum = 0;
  for (int frame = 0; frame < 20; ++frame) {
    const State before = scene.state;
    const StepReport& report = scene.step();
    ASSERT_FALSE(report.failed);
    if (report.contacts.touching == 0) continue;
    const auto error = reference.step_error(scene.model, scene.inputs, before, scene.state, scratch);
    if (!error || *error < 1e-12 || report.error_estimate <= 0) continue;
    const double ratio = std::log10(report.error_estimate / *error);
    EXPECT_LT(ratio, 1.5) << "frame " << frame << ", error " << *error;
    sum += ratio;
    ++count;
  }
  ASSERT_GT(count, 4);
  EXPECT_LT(std::abs(sum / count), 0.7);
}

// Plays a body that falls onto the ground, and compares each step's estimate with what joined() makes of the way ahead
// and of what lengths of directions foretell.
void expect_joined(const BodyDescription& body, int levels, const std::function<double(double, double)>& joined) {
  test::ContactScene scene(body, {{"ground", test::shape_of(HalfSpace{Vec3::UnitY(), 0})}}, Vec3(0, 0.13, 0));
  scene.state.v.rowwise() = Eigen::RowVector3d(0.2, -1, 0.1);
  scene.inputs.solver.levels = levels;
  scene.inputs.solver.newton = false;
  const Model& model = scene.model;
  OpenWorkspace w;
  int count = 0;
  for (int frame = 0; frame < 12; ++frame) {
    const Positions q = scene.state.x;
    const double estimate = step(model, scene.inputs, scene.state, w).motion_estimate;
    const double foretold = w.lengths.left(0) / own_motion(model, model.parts[0], q, w.y, w.current.x);
    const double ahead = motion_ahead(model, scene.inputs, q, w);
    ASSERT_EQ(foretold > 0, w.report.iterations > 1) << frame;
    if (w.report.iterations < 2) continue;
    const double expected = joined(ahead, foretold);
    EXPECT_NEAR(estimate, expected, 1e-9 * expected) << levels << ", frame " << frame;
    ++count;
  }
  EXPECT_GT(count, 5);
}

TEST(ErrorEstimate, OfMotionOfASolidIsTheMeanOfTwoForecasts) {
  for (const int levels : {1, 2}) {
    expect_joined(test::cube(3), levels,
                  [](double ahead, double foretold) { return std::max(ahead / 4, std::sqrt(ahead * foretold)); });
  }
}

TEST(ErrorEstimate, OfMotionOfClothIsTheSumOfTwoForecasts) {
  for (const BodyDescription& cloth :
       {test::spring_net(6), test::sheet({0.2, 0.2}, {6, 6}, {test::all_membranes().front(), 0.01})})
    expect_joined(cloth, 2, [](double ahead, double foretold) { return ahead + foretold; });
}

// A bar and a net that move without touching each other, and whose steps are made together.
TEST(ErrorEstimate, OfMotionIsMadeForEachPartByItsOwnRule) {
  BodyDescription net = test::spring_net(6), bar = test::bar(NeoHookean{2e4, 8e4}, test::Held::nothing);
  net.mesh.rest.rowwise() += Eigen::RowVector3d(3, 0, 0);
  const Model solid = build_model(bar), cloth = build_model(net);
  const Model both = join({&solid, &cloth});
  ASSERT_TRUE(both.parts[0].solid);
  ASSERT_FALSE(both.parts[1].solid);
  StepInputs inputs = test::still_inputs(both);
  inputs.solver.newton = false;
  State state = rest_state(both);
  for (int v = 0; v < both.vertices; ++v) state.v.row(v) = Eigen::RowVector3d(std::sin(5.0 * v), std::cos(3.0 * v), 0);
  const Positions q = state.x;
  OpenWorkspace w;
  const StepReport report = step(both, inputs, state, w);
  ASSERT_EQ(report.motion_estimates.size(), 2u);
  motion_ahead(both, inputs, q, w);
  // The way ahead is in the trial iterate's gradient, and its factor is the same for all parts.
  double times = 0;
  for (std::size_t p = 0; p < 2; ++p) {
    const Part& part = both.parts[p];
    const double motion = own_motion(both, part, q, w.y, w.current.x), foretold = w.lengths.left(p) / motion;
    const double way = mass_length(both, part, w.trial.gradient) / motion, estimate = report.motion_estimates[p];
    ASSERT_GT(foretold, 0);
    if (part.solid) {
      times = estimate * estimate / foretold / way;
    } else {
      EXPECT_NEAR(estimate, times * way + foretold, 1e-9 * estimate);
    }
  }
}

// What a workspace remembers of the directions of an earlier step is not taken for those of the next.
TEST(ErrorEstimate, OfMotionDoesNotDependOnEarlierSteps) {
  const Model model = build_model(test::bar(NeoHookean{2e4, 8e4}, test::Held::hard_end));
  StepInputs inputs = test::still_inputs(model);
  inputs.gravity = Vec3(0, -9.81, 0);
  OpenWorkspace used;
  State state = rest_state(model);
  for (const int iterations : {1, 10, 1, 2, 1}) {
    inputs.solver.iterations = iterations;
    inputs.solver.rounds = 1;
    OpenWorkspace fresh;
    State other = state;
    const double expected = step(model, inputs, other, fresh).motion_estimate;
    EXPECT_GT(expected, 0);
    EXPECT_EQ(step(model, inputs, state, used).motion_estimate, expected) << iterations;
  }
}

// A stiff bar of strain limits has no stiffness near rest: its iterations go on gaining about as much as before, and
// directions show a fifth or a tenth of what is left.
TEST(ErrorEstimate, SeesWhatIsLeftOfMotionsInWhichAMaterialIsLoose) {
  for (const double stiffness : {1e7, 1e8}) {
    const Model model = build_model(test::bar(StrainLimiting{stiffness, 0.95, 1.05, 0, 1, 1}, test::Held::hard_end));
    StepInputs inputs = test::still_inputs(model);
    inputs.gravity = Vec3(0, -9.81, 0);
    inputs.solver.iterations = 20;
    inputs.solver.newton = false;
    State state = rest_state(model);
    OpenWorkspace w, scratch;
    Reference reference(model);
    std::vector<double> ratios;
    for (int frame = 0; frame < 40; ++frame) {
      const State before = state;
      const StepReport report = step(model, inputs, state, w);
      ASSERT_FALSE(report.failed);
      const double error = reference.step_errors(model, inputs, before, state, scratch).motion;
      if (error > 1e-3) ratios.push_back(report.motion_estimate / error);
    }
    ASSERT_GT(ratios.size(), 20u);
    std::ranges::sort(ratios);
    EXPECT_GT(ratios[ratios.size() / 2], 1.0 / 3) << stiffness;
    EXPECT_LT(ratios[ratios.size() / 2], 3) << stiffness;
  }
}

}  // namespace error_estimate_test
}  // namespace supple
