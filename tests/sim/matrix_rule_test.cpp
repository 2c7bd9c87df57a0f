// Tests steps whose directions start from a matrix that follows the body: how near they come, when the matrix is
// renewed, and that a state holds all that the next step depends on.
#include "sim/solver/matrix_rule.h"

#include <gtest/gtest.h>

#include "baselines/reference.h"
#include "sim/model/model_values.h"
#include "sim/solver/lbfgs.h"
#include "support/bodies.h"
#include "support/contact_scene.h"
#include "support/snapshots.h"

namespace supple {
namespace matrix_rule_test {

using test::bar;
using test::Held;

StepInputs inputs_with(const Model& model, StartMatrix matrix) {
  StepInputs inputs = test::still_inputs(model);
  inputs.solver.matrix = matrix;
  inputs.solver.levels = 1;  // so that errors tell of the matrix alone
  return inputs;
}

TEST(MatrixRule, TheSystemIsThePapersToTheLastBit) {
  // A solve with the model's factor and nothing else.
  struct PlainInverse final : InitialInverse {
    void apply(const Model& model, const StepInputs&, OpenWorkspace& w, Positions& r, Positions& z) override {
      model.factor.solve(r.data(), z.data(), w.solve_scratch);
      restore_translation(model, r, z);
    }
  };
  for (const Held held : {Held::nothing, Held::hard_end, Held::spring_end}) {
    const Model model = build_model(bar(NeoHookean{1e4, 4e4}, held, Precision::single_precision, 2));
    const StepInputs inputs = inputs_with(model, StartMatrix::system);
    State state = rest_state(model), plain = state;
    OpenWorkspace w, other;
    PlainInverse inverse;
    LbfgsRule rule(inverse);
    for (int i = 0; i < 6; ++i) {
      step(model, inputs, state, w);
      step(model, inputs, plain, other, rule);
      EXPECT_EQ(state_hash(model, state), state_hash(model, plain)) << "step " << i;
      EXPECT_EQ(state.memory.matrix_made_at.rows(), 0);
    }
  }
}

TEST(MatrixRule, TheTangentComesNearerInTheSameIterations) {
  // The polynomial stiffens where the bar bends; of Neo-Hookean, the tangent knows the stretch alone.
  const std::pair<Material, double> cases[] = {{Polynomial{1e5}, 0.1}, {NeoHookean{2e4, 1e4}, 0.5}};
  for (const auto& [material, most] : cases) {
    const Model model = build_model(bar(material, Held::hard_end, Precision::single_precision, 3));
    const State before = test::moving_state(model, inputs_with(model, StartMatrix::tangent), 6);
    double error[2];
    Reference reference(model);
    OpenWorkspace w, scratch;
    for (const StartMatrix matrix : {StartMatrix::system, StartMatrix::tangent}) {
      const StepInputs inputs = inputs_with(model, matrix);
      State after = before;
      ASSERT_FALSE(step(model, inputs, after, w).failed);
      error[matrix == StartMatrix::tangent] = reference.step_error(model, inputs, before, after, scratch).value();
    }
    EXPECT_LT(error[1], most * error[0]) << name_of(material);
  }
}

TEST(MatrixRule, ABodyThatHardlyMovesRenewsNothing) {
  const Model model = build_model(bar(Corotated{1e5, 1e5}, Held::hard_end, Precision::single_precision, 2));
  StepInputs inputs = inputs_with(model, StartMatrix::tangent);
  inputs.gravity = Vec3(0, -0.1, 0);
  State state = rest_state(model);
  OpenWorkspace w;
  for (int i = 0; i < 10; ++i) {
    step(model, inputs, state, w);
    EXPECT_EQ(w.renewed, i == 0) << "step " << i;
    EXPECT_EQ(state.memory.matrix_made_at, model.rest);
  }
}

TEST(MatrixRule, ABodyThatStiffensRenews) {
  const Model model = build_model(bar(Polynomial{1e5}, Held::hard_end, Precision::single_precision, 2));
  const StepInputs inputs = inputs_with(model, StartMatrix::tangent);
  State state = rest_state(model);
  OpenWorkspace w;
  int renewals = 0;
  for (int i = 0; i < 10; ++i) {
    step(model, inputs, state, w);
    renewals += w.renewed;
  }
  EXPECT_GT(renewals, 2);
}

TEST(MatrixRule, AStateHoldsAllThatTheNextStepDependsOn) {
  const std::tuple<Material, StartMatrix> cases[] = {{NeoHookean{1e4, 4e4}, StartMatrix::tangent},
                                                     {Polynomial{1e5}, StartMatrix::tangent},
                                                     {NeoHookean{1e4, 4e4}, StartMatrix::turned_hessian},
                                                     {Polynomial{1e5}, StartMatrix::turned_hessian}};
  for (const auto& [material, matrix] : cases) {
    const BodyDescription body = bar(material, Held::hard_end, Precision::single_precision, 4);
    const StepInputs inputs = inputs_with(build_model(body), matrix);
    test::expect_states_to_hold_all(body, inputs, [](const State& one, const State& other) {
      EXPECT_EQ(one.memory.matrix_made_at, other.memory.matrix_made_at);
      EXPECT_EQ(one.memory.matrix_age, other.memory.matrix_age);
      EXPECT_EQ(one.memory.turned_hessian_progress, other.memory.turned_hessian_progress);
      EXPECT_EQ(one.memory.system_progress, other.memory.system_progress);
    });
  }
}

class ByMatrix : public testing::TestWithParam<StartMatrix> {};
INSTANTIATE_TEST_SUITE_P(MatrixRule, ByMatrix, testing::Values(StartMatrix::tangent, StartMatrix::turned_hessian),
                         [](const auto& matrix) {
                           return std::string(matrix.param == StartMatrix::tangent ? "tangent" : "turned_hessian");
                         });

TEST_P(ByMatrix, NewValuesOfAModelMakeTheMatrixAnew) {
  BodyDescription body = bar(NeoHookean{1e4, 4e4}, Held::hard_end, Precision::single_precision, 2);
  Model model = build_model(body);
  ModelValues values(model, body);
  const StepInputs inputs = inputs_with(model, GetParam());
  State state = rest_state(model);
  OpenWorkspace w;
  for (int i = 0; i < 4; ++i) step(model, inputs, state, w);
  body.materials = {NeoHookean{4e4, 2e4}};
  values.set(model, body);
  State resumed = state;
  const Model built = build_model(body);
  OpenWorkspace other;
  for (int i = 0; i < 4; ++i) {
    step(model, inputs, state, w);
    step(built, inputs, resumed, other);
    EXPECT_EQ(state_hash(model, state), state_hash(built, resumed));
  }
}

TEST_P(ByMatrix, IsForgottenByTheSystemAndBeginsAnew) {
  const Model model = build_model(bar(NeoHookean{1e4, 4e4}, Held::hard_end, Precision::single_precision, 2));
  State state = test::moving_state(model, inputs_with(model, GetParam()), 3);
  EXPECT_EQ(state.memory.matrix_made_at.rows(), model.vertices);
  OpenWorkspace w;
  step(model, inputs_with(model, StartMatrix::system), state, w);
  EXPECT_EQ(state.memory.matrix_made_at.rows(), 0);
  step(model, inputs_with(model, GetParam()), state, w);
  EXPECT_TRUE(w.renewed);
}

TEST_P(ByMatrix, ImplicitMidpointKeepsTheSystem) {
  BodyDescription body = bar(NeoHookean{1e4, 4e4}, Held::nothing, Precision::single_precision);
  body.integrator = Integrator::implicit_midpoint;
  const Model model = build_model(body);
  State state = rest_state(model), by_system = state;
  OpenWorkspace w;
  for (int i = 0; i < 3; ++i) {
    step(model, inputs_with(model, GetParam()), state, w);
    EXPECT_EQ(w.system, &model);
    EXPECT_FALSE(w.turned_hessian_serves);
    step(model, inputs_with(model, StartMatrix::system), by_system, w);
    EXPECT_EQ(state_hash(model, state), state_hash(model, by_system));
  }
}

TEST_P(ByMatrix, WhereNoneCanBeMadeTheSystemServes) {
  const Model model = build_model(bar(Polynomial{1e5}, Held::nothing, Precision::single_precision));
  State state = rest_state(model);
  state.v = test::shaken(Positions::Zero(model.vertices, 3), 1e170, 3);
  OpenWorkspace w;
  const StepReport& report = step(model, inputs_with(model, GetParam()), state, w);
  EXPECT_TRUE(report.failed);
  EXPECT_EQ(w.system, &model);
  EXPECT_FALSE(w.turned_hessian_serves);
}

TEST(MatrixRule, TheTurnedHessianComesMuchNearerInTheSameIterations) {
  // A bar that swings far: bent and turned, with little stretch.
  const std::pair<Material, double> cases[] = {{NeoHookean{1e5, 4e5}, 1e-3}, {Corotated{1e5, 1e5}, 1e-3}};
  for (const auto& [material, most] : cases) {
    const Model model = build_model(bar(material, Held::hard_end, Precision::single_precision, 3));
    const State before = test::moving_state(model, inputs_with(model, StartMatrix::turned_hessian), 8);
    ASSERT_EQ(before.memory.matrix_age, 7);  // the matrix is that of the first step
    double error[2];
    Reference reference(model);
    OpenWorkspace w, scratch;
    for (const StartMatrix matrix : {StartMatrix::system, StartMatrix::turned_hessian}) {
      StepInputs inputs = inputs_with(model, matrix);
      inputs.solver.iterations = 5;
      State after = before;
      ASSERT_FALSE(step(model, inputs, after, w).failed);
      EXPECT_EQ(w.turned_hessian_serves, matrix == StartMatrix::turned_hessian);
      error[matrix == StartMatrix::turned_hessian] =
          reference.step_error(model, inputs, before, after, scratch).value();
    }
    EXPECT_LT(error[1], most * error[0]) << name_of(material);
  }
}

TEST(MatrixRule, ATurnedHessianThatServesPoorlyWaitsUntilARenewalIsCheapEnough) {
  // Without stiffness at rest, and with more of it in each step.
  const Model model = build_model(bar(Polynomial{1e6}, Held::hard_end, Precision::single_precision, 2));
  const StepInputs inputs = inputs_with(model, StartMatrix::turned_hessian);
  State state = rest_state(model);
  OpenWorkspace w;
  std::vector<int> renewals;
  int served = 0;
  for (int i = 0; i < 120; ++i) {
    step(model, inputs, state, w);
    if (w.renewed) renewals.push_back(i);
    served += w.turned_hessian_serves;
    EXPECT_EQ(w.system, &model);
  }
  ASSERT_GT(renewals.size(), 1u);
  EXPECT_EQ(renewals[0], 0);
  for (std::size_t i = 1; i < renewals.size(); ++i) EXPECT_GT(renewals[i] - renewals[i - 1], 9);
  EXPECT_LT(served, 120);
}

TEST(MatrixRule, TheTurnedHessianServesOnlyWhatTouchesNothing) {
  const BodyDescription body = bar(NeoHookean{1e4, 4e4}, Held::nothing, Precision::single_precision, 2);
  test::ContactScene scene(body, {{"ground", test::shape_of(HalfSpace{Vec3::UnitY(), 0}), 0, 0.3}}, Vec3(0, 0.3, 0));
  scene.inputs.solver.matrix = StartMatrix::turned_hessian;
  State state = scene.state;
  OpenWorkspace w;
  std::vector<State> states;
  int in_the_air = 0, touching = 0;
  for (int i = 0; i < 24; ++i) {
    states.push_back(state);
    ASSERT_FALSE(step(scene.model, scene.inputs, state, w).failed);
    (w.turned_hessian_serves ? in_the_air : touching) += 1;
  }
  EXPECT_GT(in_the_air, 4);
  EXPECT_GT(touching, 4);
  for (const int from : {2, 9, 12, 15, 20}) {  // resumed in the air, and where it touches
    OpenWorkspace other;
    State resumed = states[from];
    for (int i = from; i < 24; ++i) step(scene.model, scene.inputs, resumed, other);
    EXPECT_EQ(state_hash(scene.model, resumed), state_hash(scene.model, state)) << from;
    EXPECT_EQ(resumed.memory.matrix_made_at, state.memory.matrix_made_at);
    EXPECT_EQ(resumed.memory.matrix_age, state.memory.matrix_age);
  }
}

TEST(MatrixRule, SpringsAloneKeepTheSystem) {
  const Model model = build_model(test::spring_net(4));
  State state = rest_state(model);
  OpenWorkspace w;
  step(model, inputs_with(model, StartMatrix::turned_hessian), state, w);
  EXPECT_FALSE(w.turned_hessian_serves);
  EXPECT_EQ(state.memory.matrix_made_at.rows(), 0);
}

TEST(SolverMemory, IsTheSameAfterAWayThroughBytes) {
  const SolverMemory memory{Positions::Random(5, 3), 7, 0.25, 0.125};
  const std::string bytes = bytes_of(memory);
  const std::optional<SolverMemory> again = memory_from(bytes, 5);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->matrix_made_at, memory.matrix_made_at);
  EXPECT_EQ(again->matrix_age, 7);
  EXPECT_EQ(again->turned_hessian_progress, 0.25);
  EXPECT_EQ(again->system_progress, 0.125);
  const std::optional<SolverMemory> nothing = memory_from(bytes_of(SolverMemory{}), 5);
  ASSERT_TRUE(nothing);
  EXPECT_EQ(nothing->matrix_made_at.rows(), 0);
}

TEST(SolverMemory, IsNotTakenFromBytesOfAnotherBody) {
  const std::string bytes = bytes_of(SolverMemory{Positions::Random(5, 3), 7, 0.25, 0.125});
  EXPECT_FALSE(memory_from(bytes, 6));
  EXPECT_FALSE(memory_from(bytes.substr(1), 5));
  EXPECT_FALSE(memory_from(bytes.substr(0, 5), 5));
  EXPECT_FALSE(memory_from("", 5));
}

}  // namespace matrix_rule_test
}  // namespace supple
