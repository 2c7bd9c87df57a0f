// Compares the program's g and its gradient with those that a separate program would compute from the files of a state.
#include <gtest/gtest.h>

#include "film/record/state_file.h"
#include "sim/solver/step.h"
#include "support/bodies.h"
#include "support/stored_problem.h"

namespace supple {
namespace state_objective_test {

using test::StoredProblem;

// Returns a body that is held at one end, and by springs at the other.
BodyDescription between_handles(const Material& material) {
  BodyDescription body = test::bar(material, test::Held::hard_end);
  Handle soft{"soft", {}, 300};
  for (std::int32_t v = 0; v < body.mesh.rest.rows(); ++v) {
    if (body.mesh.rest(v, 0) > 0.4 - 1e-9) soft.vertices.push_back(v);
  }
  body.handles.push_back(soft);
  return body;
}

// Returns a body of three materials, with fibres in one of them.
BodyDescription patchwork() {
  const SplineCurve b({{0.2, 300}, {0.7, 350}, {1, 500}, {1.4, 900}}), c({{0.3, -9e3}, {0.8, -3e3}, {1, -2e3}});
  const SplineCurve a({{0.4, -6e3}, {0.9, 0}, {1, 1e3}, {1.2, 4e3}, {1.5, 5e3}});
  BodyDescription body = between_handles(NeoHookean{1e4, 3e4});
  body.materials = {NeoHookean{1e4, 3e4}, Spline{a, b, c}, MooneyRivlin{6e3, 3e3, 2e4}};
  body.fibres = {Fibre{}, Fibre{3e4, {0.6, 0, 0.8}}, Fibre{}};
  body.mesh.regions.resize(body.mesh.tets.rows());
  for (std::size_t t = 0; t < body.mesh.regions.size(); ++t) body.mesh.regions[t] = int(t % 3);
  return body;
}

BodyDescription pinned_net() {
  BodyDescription body = test::spring_net(6);
  body.handles = {Handle{"hard", {0, 3}, 0}, Handle{"soft", {6, 48}, 20}};
  for (std::size_t s = 0; s < body.springs.size(); ++s) body.springs[s].stiffness = 20 + 3.0 * double(s % 7);
  return body;
}

std::vector<BodyDescription> all_bodies() {
  std::vector<BodyDescription> bodies;
  for (const Material& material : test::all_materials()) {
    bodies.push_back(between_handles(material));
    bodies.back().name = name_of(material);
    bodies.push_back(test::bar(material, test::Held::nothing));
    bodies.back().name = std::string(name_of(material)) + ", free, with fibres";
    bodies.back().fibres = {Fibre{2e4, {0, 0.6, 0.8}}};
  }
  for (const auto& [body, name] : {std::pair(patchwork(), "patchwork"), {pinned_net(), "net"}}) {
    for (const Integrator integrator : {Integrator::backward_euler, Integrator::implicit_midpoint}) {
      for (const double damping : {0.0, 0.02}) {
        bodies.push_back(body);
        bodies.back().name = name + std::string(integrator == Integrator::implicit_midpoint ? ", midpoint" : "") +
                             (damping > 0 ? ", damped" : "");
        bodies.back().integrator = integrator;
        bodies.back().damping = damping;
      }
    }
  }
  return bodies;
}

struct Agreement {
  int points = 0, inverted = 0, crushed = 0;
};

void compare(const BodyDescription& body, Agreement& agreement) {
  const test::TemporaryFolder folder;
  const Model model = build_model(body);
  StepInputs inputs = test::still_inputs(model);
  inputs.targets = test::shaken(inputs.targets, 0.02, 1);
  inputs.middle_targets = test::shaken(inputs.targets, 0.01, 2);
  State state = rest_state(model);
  state.x = test::shaken(model.rest, 0.02, 3);
  state.v = test::shaken(Positions::Zero(model.vertices, 3), 1, 4);
  write_state(folder.path, {"scene", "", 0, 0}, problem_of(body, model, inputs, state));
  const StoredProblem stored(folder.path);
  OpenWorkspace w;
  w.prepare(model, inputs.solver);
  begin_step(model, inputs, state, w);
  w.direction.setZero();
  const Positions targets = w.current.x;  // of held vertices
  const auto compare_at = [&](const Positions& point, const char* name) {
    w.current.x = targets;
    for (int v = 0; v < model.free; ++v) w.current.x.row(v) = point.row(model.input_of[v]);
    evaluate(model, w, w.current, Wanted::gradient);
    const StoredProblem::Value expected = stored.at(point);
    EXPECT_NEAR(w.current.g, expected.objective, 1e-12 * expected.size) << body.name << " at " << name;
    Positions gradient = Positions::Zero(model.vertices, 3);
    gradient.topRows(model.free) = w.current.gradient;
    const double difference = (in_input_order(model, gradient) - expected.gradient).norm();
    EXPECT_LE(difference, 1e-12 * expected.gradient.norm()) << body.name << " at " << name;
    EXPECT_GT(expected.gradient.norm(), 0) << body.name;
    ++agreement.points;
    agreement.inverted += expected.inverted;
    agreement.crushed += expected.crushed;
  };
  compare_at(stored.q, "q");
  compare_at(stored.y, "y");
  for (unsigned seed = 10; seed < 14; ++seed) {
    compare_at(test::shaken(body.mesh.rest, 0.03, seed), "a random point");
    compare_at(test::shaken(body.mesh.rest, 0.12, seed), "a random point, inverted");
  }
}

TEST(StoredObjective, AgreesWithTheProgramsForEveryMaterialSpringsFibresAndIntegrators) {
  Agreement agreement;
  for (const BodyDescription& body : all_bodies()) compare(body, agreement);
  EXPECT_GT(agreement.points, 250);
  EXPECT_GT(agreement.inverted, 1000);
  EXPECT_GT(agreement.crushed, agreement.inverted + 100);  // upright ones that log J is continued for as well
}

}  // namespace state_objective_test
}  // namespace supple
