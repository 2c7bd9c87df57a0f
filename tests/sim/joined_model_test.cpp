// Tests that a model that is joined of several bodies' models is these bodies: their matrices, forces and steps.
#include "sim/model/joined_model.h"

#include <gtest/gtest.h>

#include "sim/contact/part_contacts.h"
#include "sim/model/system_solve.h"
#include "support/contact_scene.h"

namespace supple {
namespace joined_model_test {

using test::bar;
using test::ContactScene;
using test::cube;
using test::Held;
using test::shaken;
using test::still_inputs;

// Three bodies that differ in all that a model holds: one is free, one is held and damped, one has soft handles.
struct Bodies {
  std::vector<Model> models;
  Model joined;

  Bodies() {
    BodyDescription damped = bar(Corotated{2e4, 5e4}, Held::hard_end);
    damped.damping = 0.01;
    damped.precision = Precision::double_precision;
    BodyDescription soft = bar(StVenantKirchhoff{1e4, 3e4}, Held::spring_end);
    soft.precision = Precision::double_precision;
    for (const BodyDescription& body : {cube(3), damped, soft}) models.push_back(build_model(body));
    std::vector<const Model*> members;
    for (const Model& model : models) members.push_back(&model);
    joined = join(members);
  }
};

TEST(JoinedModel, KeepsEachBodysVerticesAndMasses) {
  const Bodies all;
  double mass = 0;
  for (std::size_t p = 0; p < all.models.size(); ++p) {
    const Part& part = all.joined.parts[p];
    EXPECT_EQ(rows_of(part, all.joined.rest), all.models[p].rest);
    EXPECT_EQ(part.floats, all.models[p].parts.front().floats);
    mass += all.models[p].total_mass;
    for (std::int32_t v = 0; v < all.models[p].vertices; ++v)
      EXPECT_EQ(all.joined.part_number(joined_vertex(part, v)), p) << v;
  }
  EXPECT_DOUBLE_EQ(all.joined.total_mass, mass);
}

TEST(JoinedModel, SolvesAsItsBodiesDo) {
  const Bodies all;
  const Positions right = Positions::Random(all.joined.free, 3);
  Positions together(all.joined.free, 3);
  SolveScratch scratch;
  solve_system(all.joined, right, together, scratch);
  for (std::size_t p = 0; p < all.models.size(); ++p) {
    const Part& part = all.joined.parts[p];
    Positions alone(part.free, 3);
    solve_system(all.models[p], right.middleRows(part.first_free, part.free), alone, scratch);
    EXPECT_LT((together.middleRows(part.first_free, part.free) - alone).cwiseAbs().maxCoeff(),
              1e-14 * alone.cwiseAbs().maxCoeff());
  }
}

TEST(JoinedModel, HasTheEnergyAndForcesOfItsBodies) {
  const Bodies all;
  StepInputs inputs = still_inputs(all.joined);
  State state = rest_state(all.joined);
  std::vector<Positions> places;
  for (std::size_t p = 0; p < all.models.size(); ++p) {
    places.push_back(shaken(all.models[p].rest, 0.01, unsigned(p)));
    set_rows(all.joined.parts[p], places[p], state.x);
  }
  OpenWorkspace w, own;
  w.prepare(all.joined, inputs.solver);
  begin_step(all.joined, inputs, state, w);
  w.current.x = state.x;
  evaluate(all.joined, w, w.current, Wanted::gradient);
  double sum = 0;
  for (std::size_t p = 0; p < all.models.size(); ++p) {
    const Model& model = all.models[p];
    const StepInputs alone = still_inputs(model);
    State at = rest_state(model);
    at.x = places[p];
    own.prepare(model, alone.solver);
    begin_step(model, alone, at, own);
    own.current.x = at.x;
    evaluate(model, own, own.current, Wanted::gradient);
    sum += own.current.g;
    const Part& part = all.joined.parts[p];
    EXPECT_LT((w.current.gradient.middleRows(part.first_free, part.free) - own.current.gradient).cwiseAbs().maxCoeff(),
              1e-12 * own.current.gradient.cwiseAbs().maxCoeff());
  }
  EXPECT_NEAR(w.current.g, sum, 1e-12 * std::abs(sum));
}

// If no parts meet, each body ends the common step where it ends its own.
TEST(JoinedModel, StepsAsItsBodiesDo) {
  const Bodies all;
  StepInputs inputs = still_inputs(all.joined);
  inputs.solver.iterations = 200;
  State state = rest_state(all.joined);
  std::vector<State> alone;
  for (std::size_t p = 0; p < all.models.size(); ++p) {
    alone.push_back(rest_state(all.models[p]));
    alone[p].v = Positions::Random(all.models[p].vertices, 3);
    alone[p].v.bottomRows(all.models[p].vertices - all.models[p].free).setZero();
    set_rows(all.joined.parts[p], alone[p].v, state.v);
  }
  OpenWorkspace w, own;
  for (int k = 0; k < 3; ++k) step(all.joined, inputs, state, w);
  for (std::size_t p = 0; p < all.models.size(); ++p) {
    StepInputs of_one = still_inputs(all.models[p]);
    of_one.solver.iterations = 200;
    for (int k = 0; k < 3; ++k) step(all.models[p], of_one, alone[p], own);
    EXPECT_LT((rows_of(all.joined.parts[p], state.x) - alone[p].x).cwiseAbs().maxCoeff(), 1e-6) << p;
  }
}

// Two cubes, one on the other with faces that overlap by a millimetre, without gravity.
struct TwoCubes {
  Model one, joined;
  StepInputs inputs;
  State state;
  OpenWorkspace w;

  TwoCubes() : one(build_model(cube(4))), joined(join({&one, &one})), inputs(still_inputs(joined)) {
    inputs.gravity.setZero();
    inputs.meetings = {{1, 0, 0.5}, {0, 1, 0.5}};
    state = rest_state(joined);
    state.x.bottomRows(one.free).col(1).array() += 0.199;
  }
};

TEST(JoinedModel, PushesItsPartsApartWithoutMomentumFromNothing) {
  TwoCubes two;
  for (int k = 0; k < 10; ++k) {
    const StepReport& report = step(two.joined, two.inputs, two.state, two.w);
    ASSERT_FALSE(report.failed);
    if (k == 0) {
      EXPECT_GE(report.contacts.touching, 25);
    }
  }
  Vec3 momentum = Vec3::Zero();
  for (int v = 0; v < two.joined.free; ++v) momentum += two.joined.mass[v] * two.state.v.row(v).transpose();
  const double one = (two.state.v.topRows(two.one.free).col(1).array() * -two.one.mass.front()).sum();
  EXPECT_GT(one, 0);
  EXPECT_LT(momentum.norm(), 1e-10 * one);
  const auto rows = [&](int p) { return rows_of(two.joined.parts[p], two.state.x); };
  EXPECT_GT(rows(1).col(1).minCoeff() - rows(0).col(1).maxCoeff(), -1e-4);
}

TEST(JoinedModel, ContactsOfAPartHaveItsForces) {
  TwoCubes two;
  step(two.joined, two.inputs, two.state, two.w);
  const Positions none = Positions::Zero(two.joined.vertices, 3);
  Positions all = none;
  add_contacts(two.w.current.contacts, two.w.current.x, nullptr, none, &all);
  ASSERT_GT(all.cwiseAbs().maxCoeff(), 0);
  for (const Part& part : two.joined.parts) {
    const Positions x = rows_of(part, two.w.current.x);
    Positions own = Positions::Zero(x.rows(), 3);
    add_contacts(contacts_of_part(two.joined, part, two.w.current.contacts, two.w.current.x), x, nullptr, own, &own);
    EXPECT_LT((own - rows_of(part, all)).cwiseAbs().maxCoeff(), 1e-9 * all.cwiseAbs().maxCoeff());
  }
}

}  // namespace joined_model_test
}  // namespace supple
