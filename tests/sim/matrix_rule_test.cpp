// Tests steps whose directions start from a matrix that follows the body: how near they come, when the matrix is
// renewed, and that a state holds all that the next step depends on.
#include "sim/solver/matrix_rule.h"

#include <gtest/gtest.h>

#include "baselines/reference.h"
#include "sim/model/model_values.h"
#include "sim/solver/lbfgs.h"
#include "support/bodies.h"

namespace supple {
namespace {

using test::bar;
using test::Held;

StepInputs inputs_with(const Model& model, SystemMatrix matrix) {
  StepInputs inputs = test::still_inputs(model);
  inputs.solver.matrix = matrix;
  return inputs;
}

TEST(MatrixRule, TheConstantMatrixIsThePapersToTheLastBit) {
  // A solve with the model's factor and nothing else.
  struct PlainInverse final : InitialInverse {
    void apply(const Model& model, const StepInputs&, Workspace& w, Positions& r, Positions& z) override {
      model.factor.solve(r.data(), z.data(), w.solve_scratch.data());
      if (model.free_floating) restore_translation(model, r, z);
    }
  };
  for (const Held held : {Held::nothing, Held::hard_end, Held::spring_end}) {
    const Model model = build_model(bar(NeoHookean{1e4, 4e4}, held, Precision::single_precision, 2));
    const StepInputs inputs = inputs_with(model, SystemMatrix::constant);
    State state = rest_state(model), plain = state;
    Workspace w, other;
    PlainInverse inverse;
    LbfgsRule rule(inverse);
    for (int i = 0; i < 6; ++i) {
      step(model, inputs, state, w);
      step(model, inputs, plain, other, rule);
      EXPECT_EQ(state_hash(model, state), state_hash(model, plain)) << "step " << i;
      EXPECT_EQ(state.matrix.rows(), 0);
    }
  }
}

TEST(MatrixRule, TheTangentComesNearerInTheSameIterations) {
  // The polynomial stiffens where the bar bends; of Neo-Hookean, the tangent knows the stretch alone.
  const std::pair<Material, double> cases[] = {{Polynomial{1e5}, 0.1}, {NeoHookean{2e4, 1e4}, 0.5}};
  for (const auto& [material, most] : cases) {
    const Model model = build_model(bar(material, Held::hard_end, Precision::single_precision, 3));
    const State before = test::moving_state(model, inputs_with(model, SystemMatrix::tangent), 6);
    double error[2];
    Reference reference(model);
    Workspace w, scratch;
    for (const SystemMatrix matrix : {SystemMatrix::constant, SystemMatrix::tangent}) {
      const StepInputs inputs = inputs_with(model, matrix);
      State after = before;
      ASSERT_FALSE(step(model, inputs, after, w).failed);
      error[matrix == SystemMatrix::tangent] = reference.step_error(model, inputs, before, after, scratch).value();
    }
    EXPECT_LT(error[1], most * error[0]) << name_of(material);
  }
}

TEST(MatrixRule, ABodyThatHardlyMovesRenewsNothing) {
  const Model model = build_model(bar(Corotated{1e5, 1e5}, Held::hard_end, Precision::single_precision, 2));
  StepInputs inputs = inputs_with(model, SystemMatrix::tangent);
  inputs.gravity = Vec3(0, -0.1, 0);
  State state = rest_state(model);
  Workspace w;
  for (int i = 0; i < 10; ++i) {
    step(model, inputs, state, w);
    EXPECT_EQ(w.renewed, i == 0) << "step " << i;
    EXPECT_EQ(state.matrix, model.rest);
  }
}

TEST(MatrixRule, ABodyThatStiffensRenews) {
  const Model model = build_model(bar(Polynomial{1e5}, Held::hard_end, Precision::single_precision, 2));
  const StepInputs inputs = inputs_with(model, SystemMatrix::tangent);
  State state = rest_state(model);
  Workspace w;
  int renewals = 0;
  for (int i = 0; i < 10; ++i) {
    step(model, inputs, state, w);
    renewals += w.renewed;
  }
  EXPECT_GT(renewals, 2);
}

TEST(MatrixRule, AStateHoldsAllThatTheNextStepDependsOn) {
  for (const Material& material : {Material(NeoHookean{1e4, 4e4}), Material(Polynomial{1e5})}) {
    const BodyDescription body = bar(material, Held::hard_end, Precision::single_precision, 4);
    const Model model = build_model(body), again = build_model(body);
    const StepInputs inputs = inputs_with(model, SystemMatrix::tangent);
    State state = rest_state(model);
    Workspace w;
    std::vector<State> states;
    for (int i = 0; i < 16; ++i) {
      states.push_back(state);
      step(model, inputs, state, w);
    }
    for (const int threads_count : {1, 2, 4}) {
      for (const int from : {3, 8, 13}) {  // as if resumed there, by another model of the same body
        Threads threads(threads_count);
        Workspace other;
        other.threads = &threads;
        State resumed = states[from];
        for (int i = from; i < 16; ++i) step(again, inputs, resumed, other);
        EXPECT_EQ(state_hash(again, resumed), state_hash(model, state)) << threads_count << " threads from " << from;
        EXPECT_EQ(resumed.matrix, state.matrix);
      }
    }
    State back = states[5];  // and in the workspace that has gone further
    step(model, inputs, back, w);
    EXPECT_EQ(state_hash(model, back), state_hash(model, states[6]));
  }
}

TEST(MatrixRule, NewValuesOfAModelMakeTheMatrixAnew) {
  BodyDescription body = bar(NeoHookean{1e4, 4e4}, Held::hard_end, Precision::single_precision, 2);
  Model model = build_model(body);
  ModelValues values(model, body);
  const StepInputs inputs = inputs_with(model, SystemMatrix::tangent);
  State state = rest_state(model);
  Workspace w;
  for (int i = 0; i < 4; ++i) step(model, inputs, state, w);
  body.materials = {NeoHookean{4e4, 2e4}};
  values.set(model, body);
  State resumed = state;
  const Model built = build_model(body);
  Workspace other;
  for (int i = 0; i < 4; ++i) {
    step(model, inputs, state, w);
    step(built, inputs, resumed, other);
    EXPECT_EQ(state_hash(model, state), state_hash(built, resumed));
  }
}

TEST(MatrixRule, TheConstantMatrixForgetsAndTheTangentBeginsAnew) {
  const Model model = build_model(bar(NeoHookean{1e4, 4e4}, Held::hard_end, Precision::single_precision, 2));
  State state = test::moving_state(model, inputs_with(model, SystemMatrix::tangent), 3);
  EXPECT_EQ(state.matrix.rows(), model.vertices);
  Workspace w;
  step(model, inputs_with(model, SystemMatrix::constant), state, w);
  EXPECT_EQ(state.matrix.rows(), 0);
  step(model, inputs_with(model, SystemMatrix::tangent), state, w);
  EXPECT_TRUE(w.renewed);
}

TEST(MatrixRule, ImplicitMidpointKeepsTheConstantMatrix) {
  BodyDescription body = bar(NeoHookean{1e4, 4e4}, Held::nothing, Precision::single_precision);
  body.integrator = Integrator::implicit_midpoint;
  const Model model = build_model(body);
  State state = rest_state(model), constant = state;
  Workspace w;
  for (int i = 0; i < 3; ++i) {
    step(model, inputs_with(model, SystemMatrix::tangent), state, w);
    EXPECT_EQ(w.system, &model);
    step(model, inputs_with(model, SystemMatrix::constant), constant, w);
    EXPECT_EQ(state_hash(model, state), state_hash(model, constant));
  }
}

TEST(MatrixRule, WhereNoTangentCanBeMadeTheConstantMatrixServes) {
  const Model model = build_model(bar(Polynomial{1e5}, Held::nothing, Precision::single_precision));
  State state = rest_state(model);
  state.v = test::shaken(Positions::Zero(model.vertices, 3), 1e170, 3);
  Workspace w;
  const StepReport& report = step(model, inputs_with(model, SystemMatrix::tangent), state, w);
  EXPECT_TRUE(report.failed);
  EXPECT_EQ(w.system, &model);
}

}  // namespace
}  // namespace supple
