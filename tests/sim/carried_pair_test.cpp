// Tests steps that begin with the pair of the step before: how near they come, when the pair is dropped, and that a
// state holds all that the next step depends on.
#include "sim/solver/carried_pair.h"

#include <gtest/gtest.h>

#include <functional>

#include "baselines/reference.h"
#include "sim/model/model_values.h"
#include "support/bodies.h"
#include "support/contact_scene.h"
#include "support/snapshots.h"

namespace supple {
namespace {

using test::bar;
using test::Held;

StepInputs carrying_inputs(const Model& model, SystemMatrix matrix = SystemMatrix::constant) {
  StepInputs inputs = test::still_inputs(model);
  inputs.solver.matrix = matrix;
  inputs.solver.carry = true;
  return inputs;
}

bool same(const CarriedPair& a, const CarriedPair& b) {
  return a.step == b.step && a.gradient == b.gradient && a.system == b.system && a.misses == b.misses &&
         a.wait == b.wait;
}

// Makes a bar that both ends twist, and steps of it.
struct TwistedBar {
  Model model;
  StepInputs inputs;
  State state;
  Positions rest_targets;
  Workspace w;

  explicit TwistedBar(const Material& material) {
    BodyDescription body;
    body.name = "bar";
    body.mesh = box_mesh(Vec3(1, 0.2, 0.2), Eigen::Vector3i(10, 2, 2));
    body.materials = {material};
    Handle ends;
    for (int v = 0; v < body.mesh.rest.rows(); ++v) {
      if (body.mesh.rest(v, 0) < 1e-9 || body.mesh.rest(v, 0) > 1 - 1e-9) ends.vertices.push_back(v);
    }
    body.handles = {ends};
    model = build_model(body);
    inputs = carrying_inputs(model);
    rest_targets = inputs.targets;
    state = rest_state(model);
  }

  // Puts the targets where the ends are after `step` steps, 0.06 rad each, in opposite senses.
  void twist(int step) {
    for (Eigen::Index i = 0; i < rest_targets.rows(); ++i) {
      const Vec3 rest = rest_targets.row(i).transpose();
      const double angle = rest[0] < 0.5 ? 0.06 * step : -0.06 * step;
      const Vec3 middle(rest[0], 0.1, 0.1);
      inputs.targets.row(i) = (middle + Eigen::AngleAxisd(angle, Vec3::UnitX()) * (rest - middle)).transpose();
    }
  }
  const StepReport& make(int step) {
    twist(step);
    return supple::step(model, inputs, state, w);
  }
};

// Returns the error of equation 12 of one step with and without the pair that the state has.
std::pair<double, double> errors(const Model& model, StepInputs inputs, const State& before) {
  Workspace w, scratch;
  Reference reference(model);
  double error[2];
  for (const bool carry : {false, true}) {
    inputs.solver.carry = carry;
    State after = before;
    EXPECT_FALSE(step(model, inputs, after, w).failed);
    error[carry] = reference.step_error(model, inputs, before, after, scratch).value();
  }
  return {error[1], error[0]};
}

TEST(CarriedPair, BringsATwistingBarTenTimesNearer) {
  TwistedBar bar(NeoHookean{2e4, 2e4});
  for (int i = 1; i <= 12; ++i) ASSERT_FALSE(bar.make(i).failed);
  ASSERT_EQ(bar.state.carried.step.rows(), bar.model.free);
  bar.twist(13);
  const auto [with, without] = errors(bar.model, bar.inputs, bar.state);
  EXPECT_LT(with, 0.1 * without);
}

TEST(CarriedPair, DoesNotHarmABarWithFibres) {
  BodyDescription body = bar(Corotated{1e4, 1.5e4}, Held::hard_end, Precision::single_precision, 3);
  const double part = std::sqrt(1.0 / 3);
  body.fibres = {{2e5, {part, part, part}}};
  const Model model = build_model(body);
  const StepInputs inputs = carrying_inputs(model);
  State state = rest_state(model);
  Workspace w;
  double log_ratio = 0;
  int states = 0;
  for (int i = 0; i < 40; ++i) {
    if (i >= 10 && i % 3 == 0) {
      const auto [with, without] = errors(model, inputs, state);
      log_ratio += std::log(std::max(with, 1e-13) / std::max(without, 1e-13));
      ++states;
    }
    ASSERT_FALSE(step(model, inputs, state, w).failed);
  }
  EXPECT_LT(std::exp(log_ratio / states), 1.1);
}

TEST(CarriedPair, IsTheSumOfTheStepsPairs) {
  const Model model = build_model(bar(NeoHookean{1e4, 4e4}, Held::hard_end));
  StepInputs inputs = carrying_inputs(model);
  State state = rest_state(model);
  Workspace w;
  step(model, inputs, state, w);
  const Positions& s = state.carried.step;
  ASSERT_EQ(s.rows(), model.free);
  const Positions first = state.x.topRows(model.free) - s;  // where the iterations began
  EXPECT_LT((first - w.y.topRows(model.free)).norm(), 1e-9 * s.norm() + 1e-12);
  EXPECT_GT(s.cwiseProduct(state.carried.gradient).sum(), 0);
}

TEST(CarriedPair, IsNeitherUsedNorKeptUnlessAskedFor) {
  const Model model = build_model(bar(NeoHookean{1e4, 4e4}, Held::hard_end));
  StepInputs inputs = carrying_inputs(model);
  State state = rest_state(model);
  Workspace w;
  for (int i = 0; i < 3; ++i) step(model, inputs, state, w);
  ASSERT_GT(state.carried.step.rows(), 0);
  State plain = state;
  plain.carried = {};
  inputs.solver.carry = false;
  Workspace other;
  step(model, inputs, state, w);
  step(model, inputs, plain, other);
  EXPECT_EQ(state_hash(model, state), state_hash(model, plain));
  EXPECT_EQ(state.carried.step.rows(), 0);
  EXPECT_EQ(state.carried.system, 0u);
}

TEST(CarriedPair, IsNotUsedWhenTheBodysValuesHaveChanged) {
  BodyDescription body = bar(NeoHookean{1e4, 4e4}, Held::spring_end, Precision::single_precision, 2);
  const BodyDescription given = body;
  const auto stiffer = [](BodyDescription& b) { b.materials = {NeoHookean{2e4, 4e4}}; };
  const auto shorter_steps = [](BodyDescription& b) { b.time_step *= 0.5; };
  const auto let_go = [](BodyDescription& b) { b.handles.front().holds = false; };
  for (const std::function<void(BodyDescription&)>& change :
       {std::function<void(BodyDescription&)>(stiffer), std::function<void(BodyDescription&)>(shorter_steps),
        std::function<void(BodyDescription&)>(let_go)}) {
    body = given;
    Model model = build_model(body);
    ModelValues values(model, body);
    StepInputs inputs = carrying_inputs(model);
    State state = rest_state(model);
    Workspace w;
    for (int i = 0; i < 4; ++i) step(model, inputs, state, w);
    ASSERT_GT(state.carried.step.rows(), 0);
    change(body);
    values.set(model, body);
    State without = state;
    without.carried = {};
    Workspace other;
    step(model, inputs, state, w);
    EXPECT_FALSE(w.carrying.used);
    step(model, inputs, without, other);
    EXPECT_EQ(state_hash(model, state), state_hash(model, without));
    EXPECT_TRUE(same(state.carried, without.carried));
    for (int i = 0; i < 3; ++i) step(model, inputs, state, w);
    EXPECT_TRUE(w.carrying.used);  // the new values have a pair of their own
  }
}

TEST(CarriedPair, ThatMisleadsIsDroppedAndAttemptsBecomeRare) {
  const Model model = build_model(bar(NeoHookean{1e4, 4e4}, Held::hard_end, Precision::single_precision, 2));
  StepInputs inputs = carrying_inputs(model);
  inputs.solver.iterations = 20;  // a step that ends unsolved would leave no pair to spoil
  State state = rest_state(model);
  Workspace w;
  for (int i = 0; i < 4; ++i) step(model, inputs, state, w);
  std::vector<int> attempts;
  for (int i = 0; i < 40; ++i) {
    state.carried.gradient *= 50;  // far stiffer than the body is
    step(model, inputs, state, w);
    if (!w.carrying.used) continue;
    EXPECT_TRUE(w.carrying.misled);
    attempts.push_back(i);
  }
  EXPECT_EQ(attempts, (std::vector<int>{0, 2, 6, 14, 30}));
  while (state.carried.wait > 0) step(model, inputs, state, w);
  step(model, inputs, state, w);  // with its own pair it serves again
  EXPECT_TRUE(w.carrying.used);
  EXPECT_FALSE(w.carrying.misled);
  EXPECT_EQ(state.carried.misses, 0);
  EXPECT_EQ(state.carried.wait, 0);
}

TEST(CarriedPair, OfAStepThatEndsUnsolvedIsNotKept) {
  const Model model = build_model(bar(NeoHookean{1e4, 4e4}, Held::hard_end));
  StepInputs inputs = carrying_inputs(model);
  inputs.solver.rounds = 1;
  for (const int iterations : {1, 10}) {
    inputs.solver.iterations = iterations;
    State state = rest_state(model);
    Workspace w;
    const StepReport& report = step(model, inputs, state, w);
    EXPECT_EQ(report.error_estimate > 1e-3, iterations == 1);
    EXPECT_EQ(state.carried.wait, iterations == 1 ? 1 : 0);
  }
}

TEST(CarriedPair, IsNeitherTakenNorLeftByAStepThatTouches) {
  // A cube that wobbles as it falls 0.2 m.
  const Shape block = test::shape_of(Box{Vec3(1, 0.5, 1), 0});
  test::ContactScene scene(test::cube(3), {{"block", block, 0, 0.4}}, Vec3(0, 0.8, 0));
  scene.state.v.col(0) = 5 * scene.state.x.col(0);
  int in_the_air = 0, touching = 0;
  for (int i = 0; i < 16; ++i) {
    ASSERT_FALSE(scene.step().failed);
    const bool touches = !scene.w.current.contacts.empty();
    if (touches) {
      EXPECT_EQ(scene.state.carried.wait, 1) << i;
      EXPECT_FALSE(scene.w.carrying.used && touching > 0) << i;
    }
    in_the_air += scene.w.carrying.used;
    touching += touches;
  }
  EXPECT_GT(in_the_air, 2);
  EXPECT_GT(touching, 4);
}

TEST(CarriedPair, OfCurvatureThatIsNotPositiveIsNotKept) {
  EXPECT_FALSE(is_safely_positive(0, 0, 0));
  EXPECT_FALSE(is_safely_positive(-1, 1, 1));
  EXPECT_FALSE(is_safely_positive(1e-11, 1, 1));
  EXPECT_FALSE(is_safely_positive(std::nan(""), 1, 1));
  EXPECT_TRUE(is_safely_positive(1e-9, 1, 1));
}

TEST(CarriedPair, AWindowOfOneIsEnoughAndWithoutAWindowThereIsNone) {
  const Model model = build_model(bar(NeoHookean{1e4, 4e4}, Held::hard_end));
  for (const int window : {0, 1, 2}) {
    StepInputs inputs = carrying_inputs(model);
    inputs.solver.history = window;
    State state = rest_state(model);
    Workspace w;
    for (int i = 0; i < 6; ++i) {
      ASSERT_FALSE(step(model, inputs, state, w).failed);
    }
    EXPECT_EQ(state.carried.step.rows(), window == 0 ? 0 : model.free);
  }
}

TEST(CarriedPair, AStateHoldsAllThatTheNextStepDependsOn) {
  for (const SystemMatrix matrix : {SystemMatrix::constant, SystemMatrix::tangent, SystemMatrix::hessian}) {
    const BodyDescription body = bar(Polynomial{1e5}, Held::hard_end, Precision::single_precision, 4);
    const StepInputs inputs = carrying_inputs(build_model(body), matrix);
    test::expect_states_to_hold_all(
        body, inputs, [](const State& one, const State& other) { EXPECT_TRUE(same(one.carried, other.carried)); });
  }
}

TEST(CarriedPair, LandsWithABodyThatFalls) {
  for (const ContactHistory history : {ContactHistory::current, ContactHistory::frozen, ContactHistory::dropped}) {
    const BodyDescription body = bar(NeoHookean{1e4, 4e4}, Held::nothing, Precision::single_precision, 2);
    test::ContactScene scene(body, {{"ground", test::shape_of(HalfSpace{Vec3::UnitY(), 0}), 0, 0.3}}, Vec3(0, 0.3, 0));
    scene.inputs.solver.carry = true;
    scene.inputs.solver.contact.history = history;
    State state = scene.state;
    Workspace w;
    std::vector<State> states;
    bool touched = false;
    for (int i = 0; i < 24; ++i) {
      states.push_back(state);
      ASSERT_FALSE(step(scene.model, scene.inputs, state, w).failed);
      const bool rests = touched && !w.current.contacts.empty();
      touched = !w.current.contacts.empty();
      if (history != ContactHistory::current && rests) {
        EXPECT_GT(state.carried.wait, 0);  // its gradients contain the ground
      }
    }
    for (const int from : {2, 12, 20}) {  // resumed in the air, and where it touches
      Workspace other;
      State resumed = states[from];
      for (int i = from; i < 24; ++i) step(scene.model, scene.inputs, resumed, other);
      EXPECT_EQ(state_hash(scene.model, resumed), state_hash(scene.model, state)) << from;
      EXPECT_TRUE(same(resumed.carried, state.carried));
    }
  }
}

}  // namespace
}  // namespace supple
