#include "support/objective_checks.h"

#include <gtest/gtest.h>

#include "support/bodies.h"

namespace supple::test {

void expect_derivative_of_objective(const BodyDescription& body, const std::string& name) {
  const Model model = build_model(body);
  Workspace w;
  FrameInputs inputs = still_inputs(model);
  inputs.middle_targets = inputs.targets;
  inputs.middle_targets.array() += 0.003;
  inputs.targets.array() += 0.01;
  w.prepare(model, inputs.solver);
  State state = rest_state(model);
  state.x = shaken(model.rest, 0.01, 3);
  state.v = shaken(Positions::Zero(model.vertices, 3), 1, 5);
  begin_step(model, inputs, state, w);
  w.x.topRows(model.free) = shaken(model.rest, 0.02, 4).topRows(model.free);
  w.direction = shaken(Positions::Zero(model.free, 3), 1, 6);
  const Change at = evaluate(model, w, w.x, w.energy, &w.gradient, nullptr, nullptr);
  const auto value_at = [&](double step) {
    w.trial = w.x;
    w.trial.topRows(model.free) += step * w.direction;
    return evaluate(model, w, w.trial, w.trial_energy, nullptr, nullptr, nullptr).value;
  };
  double best = 1e300;
  for (const double h : {1e-4, 1e-5, 1e-6, 1e-7})
    best = std::min(best, std::abs((value_at(h) - value_at(-h)) / (2 * h) - at.slope));
  EXPECT_LT(best, 1e-6 * std::abs(at.slope)) << name;
  const double value = value_at(1e-3);
  const double change = evaluate(model, w, w.trial, w.trial_energy, nullptr, &w.x, &w.energy).value;
  EXPECT_NEAR(change, value - at.value, 1e-11 * std::abs(value)) << name;
}

AgainstStaying against_staying(const Model& model, const FrameInputs& inputs, const State& before, const State& after) {
  Workspace w;
  w.prepare(model, inputs.solver);
  begin_step(model, inputs, before, w);
  w.x.topRows(model.free) = before.x.topRows(model.free);
  const auto normal_energy = [&](const Positions& x) {  // without friction, which only takes energy
    if (inputs.colliders == nullptr || inputs.colliders->empty()) return 0.0;
    find_contacts(model, inputs, x, w);
    const double energy = contact_energy(w.contact.found, x);
    w.contact.found.clear();
    return energy;
  };
  const double contacts = normal_energy(w.x);
  const double staying = evaluate(model, w, w.x, w.energy, nullptr, nullptr, nullptr).value + contacts;
  const double change = evaluate(model, w, after.x, w.trial_energy, nullptr, &w.x, &w.energy).value;
  return {staying, change + normal_energy(after.x) - contacts};
}

}  // namespace supple::test
