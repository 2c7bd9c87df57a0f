#include "support/objective_checks.h"

#include <gtest/gtest.h>

#include "support/bodies.h"

namespace supple::test {

void expect_derivative_of_objective(const BodyDescription& body, const std::string& name, const Wind& wind,
                                    const std::vector<PartAir>& air) {
  const Model model = build_model(body);
  OpenWorkspace w;
  StepInputs inputs = still_inputs(model);
  inputs.middle_targets = inputs.targets;
  inputs.middle_targets.array() += 0.003;
  inputs.targets.array() += 0.01;
  inputs.wind = wind;
  inputs.air = air;
  w.prepare(model, inputs.solver);
  State state = rest_state(model);
  state.x = shaken(model.rest, 0.01, 3);
  state.v = shaken(Positions::Zero(model.vertices, 3), 1, 5);
  begin_step(model, inputs, state, w);
  w.current.x.topRows(model.free) = shaken(model.rest, 0.02, 4).topRows(model.free);
  w.direction = shaken(Positions::Zero(model.free, 3), 1, 6);
  evaluate(model, w, w.current, Wanted::gradient);
  const double slope = w.current.gradient.cwiseProduct(w.direction).sum();
  const auto value_at = [&](double step) {
    set_trial(model, w, step);
    evaluate(model, w, w.trial, Wanted::value);
    return w.trial.g;
  };
  double best = 1e300;
  for (const double h : {1e-4, 1e-5, 1e-6, 1e-7})
    best = std::min(best, std::abs((value_at(h) - value_at(-h)) / (2 * h) - slope));
  EXPECT_LT(best, 1e-6 * std::abs(slope)) << name;
  const double value = value_at(1e-3);
  const Change change = evaluate_trial(model, w, Wanted::gradient);
  EXPECT_NEAR(change.value, value - w.current.g, 1e-11 * std::abs(value)) << name;
  const double slope_there = w.trial.gradient.cwiseProduct(w.direction).sum();
  EXPECT_NEAR(change.slope, slope_there, 1e-11 * std::abs(slope_there)) << name;
}

AgainstStaying against_staying(const Model& model, const StepInputs& inputs, const State& before, const State& after) {
  OpenWorkspace w;
  w.prepare(model, inputs.solver);
  begin_step(model, inputs, before, w);
  w.current.x.topRows(model.free) = before.x.topRows(model.free);
  const auto normal_energy = [&](const Positions& x) {  // without friction, which only takes energy
    if (!has_colliders(inputs)) return 0.0;
    std::vector<Contact> found;
    find_contacts(model, inputs, x, nullptr, w.contact, found);
    return contact_energy(found, x);
  };
  const double contacts = normal_energy(w.current.x);
  evaluate(model, w, w.current, Wanted::value);
  w.trial.x = after.x;
  const double change = evaluate_trial(model, w, Wanted::value).value;
  return {w.current.g + contacts, change + normal_energy(after.x) - contacts};
}

}  // namespace supple::test
