// Tests that a model whose numbers were changed equals a model that is built with the new numbers.
#include <gtest/gtest.h>

#include "sim/model/model_values.h"
#include "support/bodies.h"

namespace supple {
namespace model_values_test {

// Returns the hash after one step from a shaken rest state.
std::uint64_t hash_of_step(const Model& model) {
  State state = rest_state(model);
  const Positions shaken = test::shaken(in_input_order(model, model.rest), 0.01 * model.size, 3);
  for (int v = 0; v < model.free; ++v) state.x.row(v) = shaken.row(model.input_of[v]);
  OpenWorkspace workspace;
  const StepReport& report = step(model, test::still_inputs(model), state, workspace);
  EXPECT_FALSE(report.failed);
  return state_hash(model, state);
}

// Changes `body` in place and compares it with a model that was built with the new values.
template <class Change>
void expect_as_built(BodyDescription body, const Change& change) {
  Model model = build_model(body);
  const std::uint64_t before = hash_of_step(model), id = model.id;
  ModelValues values(model, body);
  const BodyDescription first = body;
  change(body);
  values.set(model, body);
  const Model built = build_model(body);
  EXPECT_NE(model.id, id);
  EXPECT_EQ(model.diagonal, built.diagonal);
  EXPECT_EQ(model.mass, built.mass);
  EXPECT_EQ(model.field, built.field);
  EXPECT_EQ(model.handle_stiffness, built.handle_stiffness);
  EXPECT_EQ(model.damping.value, built.damping.value);
  EXPECT_EQ(model.parts[0].floats, built.parts[0].floats);
  EXPECT_EQ(model.parts[0].mass, built.parts[0].mass);
  EXPECT_EQ(model.couplings.size(), built.couplings.size());
  EXPECT_EQ(hash_of_step(model), hash_of_step(built));
  EXPECT_NE(hash_of_step(model), before);
  values.set(model, first);  // and changes it back
  EXPECT_EQ(hash_of_step(model), before);
}

TEST(ModelValues, MaterialsAndFibres) {
  const BodyDescription body = test::bar(NeoHookean{1e4, 4e4}, test::Held::hard_end);
  expect_as_built(body, [](BodyDescription& b) { b.materials = {Corotated{3e4, 1e4}}; });
  expect_as_built(body, [](BodyDescription& b) {
    Fibre fibre;
    fibre.kappa = 1e5;
    fibre.direction[1] = 1;
    fibre.direction[0] = fibre.direction[2] = 0;
    b.fibres.assign(b.materials.size(), fibre);
  });
}

TEST(ModelValues, MassTimeStepIntegratorDampingAndFit) {
  const BodyDescription body = test::bar(NeoHookean{1e4, 4e4}, test::Held::hard_end);
  expect_as_built(body, [](BodyDescription& b) { b.density *= 2; });
  expect_as_built(body, [](BodyDescription& b) { b.time_step /= 4; });
  expect_as_built(body, [](BodyDescription& b) { b.integrator = Integrator::implicit_midpoint; });
  expect_as_built(body, [](BodyDescription& b) { b.damping = 0.01; });
  expect_as_built(test::bar(Polynomial{1e5}, test::Held::nothing), [](BodyDescription& b) { b.fit = {0.3, 2}; });
}

TEST(ModelValues, SpringsOfClothAndOfHandles) {
  expect_as_built(test::spring_net(6), [](BodyDescription& b) {
    for (Spring& spring : b.springs) spring.stiffness *= 3;
  });
  const BodyDescription held = test::bar(NeoHookean{1e4, 4e4}, test::Held::spring_end);
  expect_as_built(held, [](BodyDescription& b) { b.handles[0].stiffness *= 10; });
  expect_as_built(held, [](BodyDescription& b) { b.handles[0].holds = false; });
}

TEST(ModelValues, AHandleThatLetGoPullsAtNothing) {
  BodyDescription held = test::bar(NeoHookean{1e4, 4e4}, test::Held::spring_end), free = held;
  held.handles[0].holds = false;
  free.handles.clear();
  const Model let_go = build_model(held), never_held = build_model(free);
  EXPECT_TRUE(let_go.parts[0].floats);
  EXPECT_EQ(hash_of_step(let_go), hash_of_step(never_held));
}

}  // namespace model_values_test
}  // namespace supple
