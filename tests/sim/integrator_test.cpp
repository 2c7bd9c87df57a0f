// Tests implicit midpoint, stiffness-proportional damping, springs and fibres: their objectives and gradients must
// agree, and they must show the physics for which they are chosen.
#include <gtest/gtest.h>

#include "sim/measures/energies.h"
#include "sim/measures/measures.h"
#include "support/bodies.h"
#include "support/objective_checks.h"

namespace supple {
namespace integrator_test {

using test::bar;
using test::Held;
using test::still_inputs;

std::vector<BodyDescription> all_objectives() {
  std::vector<BodyDescription> list;
  for (const Integrator integrator : {Integrator::backward_euler, Integrator::implicit_midpoint}) {
    for (const double damping : {0.0, 0.02}) {
      for (const Held held : {Held::nothing, Held::hard_end, Held::spring_end}) {
        BodyDescription body = bar(NeoHookean{1e4, 3e4}, held);
        body.fibres = {Fibre{2e4, {0.6, 0.8, 0}}};
        body.integrator = integrator;
        body.damping = damping;
        list.push_back(body);
      }
      list.push_back(test::spring_net(5));
      list.back().integrator = integrator;
      list.back().damping = damping;
    }
  }
  return list;
}

TEST(Integrators, GradientAndDifferencesAgreeForEveryObjective) {
  for (const BodyDescription& body : all_objectives())
    test::expect_derivative_of_objective(body, body.name + (body.damping > 0 ? ", damped" : ""));
}

// The matrix of the model must be the second derivative of g where g is quadratic.
TEST(Integrators, TheSystemMatrixIsTheHessianOfTheQuadraticPart) {
  for (const Integrator integrator : {Integrator::backward_euler, Integrator::implicit_midpoint}) {
    // The material is as-rigid-as-possible with k = 2 mu: near rest, for a deformation without rotation, g is quadratic
    // with A.
    BodyDescription body = bar(AsRigidAsPossible{1e4}, Held::spring_end);
    body.integrator = integrator;
    body.damping = 0.01;
    const Model model = build_model(body);
    OpenWorkspace w;
    StepInputs inputs = still_inputs(model);
    inputs.middle_targets = inputs.targets;
    inputs.gravity.setZero();
    w.prepare(model, inputs.solver);
    State state = rest_state(model);
    begin_step(model, inputs, state, w);
    // A uniform, symmetric stretch keeps R the identity everywhere.
    const double strain = 1e-4;
    w.current.x = model.rest;
    w.current.x.col(0) *= 1 + strain;
    w.current.x.col(1) *= 1 - 0.5 * strain;
    evaluate(model, w, w.current, Wanted::gradient);
    Positions solved(model.free, 3);
    model.factor.solve(w.current.gradient.data(), solved.data(), w.solve_scratch);
    EXPECT_LT((solved - (w.current.x - model.rest).topRows(model.free)).norm(),
              1e-6 * (w.current.x - model.rest).norm());
  }
}

State swinging(const Model& model, StepInputs inputs, int frames, double* largest_energy = nullptr) {
  State state = rest_state(model);
  state.v.col(1) = 2 * model.rest.col(0);
  inputs.middle_targets = inputs.targets;
  inputs.gravity.setZero();
  OpenWorkspace w;
  for (int frame = 0; frame < frames; ++frame) {
    step(model, inputs, state, w);
    if (largest_energy != nullptr)
      *largest_energy = std::max(*largest_energy, energies(model, state, inputs.gravity, w).total());
  }
  return state;
}

double energy_after(const BodyDescription& body, int frames) {
  const Model model = build_model(body);
  StepInputs inputs = still_inputs(model);
  inputs.solver.iterations = 100;
  const State state = swinging(model, inputs, frames);
  OpenWorkspace w;
  w.prepare(model, inputs.solver);
  return energies(model, state, Vec3::Zero(), w).total();
}

TEST(Integrators, MidpointKeepsTheEnergyThatBackwardEulerAndDampingLose) {
  BodyDescription body = bar(Corotated{2e4, 2e4}, Held::hard_end, Precision::double_precision, 2);
  const Model model = build_model(body);
  double start = 0;
  for (int v = 0; v < model.free; ++v) start += 0.5 * model.mass[v] * std::pow(2 * model.rest(v, 0), 2);
  const double euler = energy_after(body, 60);
  body.integrator = Integrator::implicit_midpoint;
  const double midpoint = energy_after(body, 60);
  body.damping = 0.02;
  const double damped_midpoint = energy_after(body, 60);
  body.integrator = Integrator::backward_euler;
  const double damped_euler = energy_after(body, 60);
  EXPECT_NEAR(midpoint / start, 1, 0.15);
  EXPECT_LT(euler, 0.6 * start);
  EXPECT_LT(damped_midpoint, 0.5 * midpoint);
  EXPECT_LT(damped_euler, euler);
}

TEST(Integrators, MidpointIsOfSecondOrderAndBackwardEulerOfFirst) {
  const auto end_position = [](Integrator integrator, int steps) {
    BodyDescription body = bar(Corotated{2e4, 2e4}, Held::hard_end);
    body.integrator = integrator;
    body.time_step = 0.08 / steps;
    const Model model = build_model(body);
    StepInputs inputs = still_inputs(model);
    inputs.solver.iterations = 300;
    return swinging(model, inputs, steps).x;
  };
  const Positions exact = end_position(Integrator::implicit_midpoint, 512);
  const auto order = [&](Integrator integrator) {
    const double coarse = (end_position(integrator, 32) - exact).norm(),
                 fine = (end_position(integrator, 64) - exact).norm();
    return std::log2(coarse / fine);
  };
  EXPECT_NEAR(order(Integrator::backward_euler), 1, 0.25);
  EXPECT_NEAR(order(Integrator::implicit_midpoint), 2, 0.25);
}

TEST(Integrators, BothFallFreelyAndKeepMomentum) {
  for (const double damping : {0.0, 0.05}) {
    BodyDescription body = bar(NeoHookean{1e4, 3e4}, Held::nothing, Precision::single_precision, 2);
    body.integrator = Integrator::implicit_midpoint;
    body.damping = damping;
    const Model model = build_model(body);
    const StepInputs inputs = still_inputs(model);
    State state = rest_state(model);
    OpenWorkspace w;
    const int frames = 30;
    for (int frame = 0; frame < frames; ++frame) step(model, inputs, state, w);
    // Midpoint is exact under constant acceleration.
    const double t = model.time_step * frames, fall = -0.5 * 9.81 * t * t;
    EXPECT_LT((state.x.col(1).array() - model.rest.col(1).array() - fall).abs().maxCoeff(), 1e-9);
    EXPECT_LT((state.v.col(1).array() + 9.81 * t).abs().maxCoeff(), 1e-9);
  }
}

TEST(Integrators, EveryStepOfEveryObjectiveIsNoWorseThanStaying) {
  for (const BodyDescription& body : all_objectives()) {
    const Model model = build_model(body);
    StepInputs inputs = still_inputs(model);
    inputs.middle_targets = inputs.targets;
    inputs.solver.iterations = 1;  // deliberately too few
    State state = rest_state(model);
    state.x.topRows(model.free) = test::shaken(model.rest, 0.05, 3).topRows(model.free);
    OpenWorkspace w;
    for (int frame = 0; frame < 40; ++frame) {
      const State before = state;
      step(model, inputs, state, w);
      const auto [staying, change] = test::against_staying(model, inputs, before, state);
      EXPECT_LE(change, 1e-12 * std::abs(staying)) << body.name << " frame " << frame;
    }
  }
}

// Makes a mass of 2 kg on a spring of 1 m and 40 N/m.
BodyDescription weight_on_a_spring() {
  BodyDescription body;
  body.name = "spring";
  body.mesh.rest.resize(2, 3);
  body.mesh.rest << 0, 0, 0, 0, -1, 0;
  body.mesh.tets.resize(0, 4);
  body.springs = {{0, 1, 1.0, 40.0}};
  body.point_mass = {1, 2};
  body.handles = {Handle{"top", {0}, 0}};
  body.precision = Precision::double_precision;
  return body;
}

TEST(Springs, AndFibresAreWholeInTheSystemMatrix) {
  // Both are linear along their own direction, so one plain quasi-Newton iteration must end at the minimum; a softer or
  // stiffer matrix would fall short or overshoot. The fibres run along y in a box that its weight pulls along y; the
  // base material is so soft that it has no influence.
  BodyDescription fibre = bar(AsRigidAsPossible{1e-6}, Held::nothing);
  fibre.fibres = {Fibre{1e4, {0, 1, 0}}};
  fibre.handles = {Handle{"top", {}, 0}};
  for (std::int32_t v = 0; v < fibre.mesh.rest.rows(); ++v) {
    if (fibre.mesh.rest(v, 1) > 0.1 - 1e-9) fibre.handles[0].vertices.push_back(v);
  }
  for (const BodyDescription& body : {weight_on_a_spring(), fibre}) {
    const Model model = build_model(body);
    StepInputs inputs = still_inputs(model);
    inputs.solver.iterations = 1;
    inputs.solver.history = 0;
    State state = rest_state(model);
    OpenWorkspace w;
    const StepReport& report = step(model, inputs, state, w);
    const double gained = report.objective.front() - report.objective.back();
    begin_step(model, inputs, rest_state(model), w);
    w.current.x = state.x;
    evaluate(model, w, w.current, Wanted::gradient);
    Positions left(model.free, 3);
    model.factor.solve(w.current.gradient.data(), left.data(), w.solve_scratch);
    EXPECT_LT(w.current.gradient.cwiseProduct(left).sum(), 1e-6 * std::max(gained, 1e-12)) << body.name;
  }
}

TEST(Springs, HangLongerByTheirLoad) {
  BodyDescription body = weight_on_a_spring();
  body.time_step = 1;
  const Model model = build_model(body);
  StepInputs inputs = still_inputs(model);
  inputs.solver.iterations = 50;
  State state = rest_state(model);
  OpenWorkspace w;
  for (int frame = 0; frame < 200; ++frame) step(model, inputs, state, w);
  EXPECT_NEAR(in_input_order(model, state.x)(1, 1), -1 - 2 * 9.81 / 40, 1e-9);
}

TEST(Fibres, StiffenTheirDirectionAndNoOther) {
  const auto sag = [](const Vec3& direction) {
    BodyDescription body = bar(Corotated{1e4, 1e4}, Held::hard_end, Precision::double_precision, 2);
    body.fibres = {Fibre{4e5, {direction.x(), direction.y(), direction.z()}}};
    const Model model = build_model(body);
    StepInputs inputs = still_inputs(model);
    inputs.gravity = Vec3(40, 0, 0);  // along the bar
    inputs.solver.iterations = 50;
    State state = rest_state(model);
    OpenWorkspace w;
    for (int frame = 0; frame < 200; ++frame) step(model, inputs, state, w);
    return (state.x - model.rest).col(0).maxCoeff();
  };
  const double along = sag(Vec3::UnitX()), across = sag(Vec3::UnitY());
  EXPECT_LT(along, 0.2 * across);
}

}  // namespace integrator_test
}  // namespace supple
