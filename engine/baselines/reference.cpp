#include "baselines/reference.h"

#include <cmath>

#include "baselines/newton.h"
#include "sim/model/motion_error.h"
#include "sim/solver/iterations.h"

namespace supple {
namespace {

constexpr int newton_iterations = 100;
constexpr int first_iterations = 300;  // of L-BFGS, before Newton's: cheap, and often enough near a minimum in contact
constexpr int check_iterations = 300;  // of L-BFGS after Newton's method
constexpr int slow_iterations = 5000;  // of L-BFGS where Newton's line search gives up (a crease of the contact set)
// A minimisation ends where the slope of its direction is below this share of g(y) - g(x). The slope bounds, to within
// a small factor, what is left to gain, which is then far below the digits that a report shows.
constexpr double digits = 1e-12;

StepInputs thorough(const StepInputs& inputs, int iterations, int history) {
  StepInputs result = inputs;
  result.solver = SolverSettings{};
  result.solver.iterations = iterations;
  result.solver.history = history;
  result.solver.contact = inputs.solver.contact;
  result.solver.contact.direction = ContactDirection::low_rank;
  return result;
}

}  // namespace

struct Reference::Parts {
  explicit Parts(const Model& model) : newton(model, Safeguard::projection), hessian(model) {
    factor.analyze(hessian.matrix());
  }
  NewtonRule newton;
  HessianMatrix hessian;
  ChangingFactor factor;
};

Reference::Reference(const Model& model) : parts_(std::make_unique<Parts>(model)) {}
Reference::~Reference() = default;

double contact_energy_at(const Model& model, const StepInputs& inputs, const Positions& x, OpenWorkspace& w) {
  if (!may_touch(inputs)) return 0;
  std::vector<Contact> found;
  find_contacts(model, inputs, x, w.threads, w.contact, found);
  return add_contacts(found, x, nullptr, w.direction, nullptr).value;
}

double gained(const Model& model, const StepInputs& inputs, const State& before, const Positions& x, OpenWorkspace& w) {
  w.prepare(model, inputs.solver);
  begin_step(model, inputs, before, w);
  // The gain is summed as a difference. The handles of y are at their targets, whatever the solver started from.
  const double contacts_at_start = contact_energy_at(model, inputs, w.current.x, w);
  evaluate(model, w, w.current, Wanted::value);
  w.trial.x.topRows(model.free) = x.topRows(model.free);
  const double change = evaluate_trial(model, w, Wanted::value).value;
  const double contacts = contacts_at_start - contact_energy_at(model, inputs, w.trial.x, w);
  std::swap(w.current, w.trial);
  return contacts - change;
}

Minimum Reference::minimum(const Model& model, const StepInputs& inputs, const State& before, const Positions& x,
                           OpenWorkspace& w) {
  const StepInputs by_newton = thorough(inputs, newton_iterations, 0);
  const StepInputs by_lbfgs = thorough(inputs, check_iterations, 20);
  w.prepare(model, by_lbfgs.solver);
  w.report = StepReport{};
  Minimum result;
  const double reached = gained(model, by_newton, before, x, w);
  const double enough = digits * std::abs(reached);
  minimize(model, thorough(inputs, first_iterations, 20), w, enough);
  minimize(model, by_newton, w, parts_->newton, enough);
  const bool gave_up = w.report.stop_reason == StopReason::line_search_failed;
  minimize(model, gave_up ? thorough(inputs, slow_iterations, 20) : by_lbfgs, w, enough);
  result.below_end = w.report.decrease;
  result.below_y = reached + result.below_end;
  result.x = w.current.x;
  parts_->hessian.assemble(model, w, false);
  result.positive_definite = parts_->factor.factorize(parts_->hessian.matrix());
  return result;
}

Reference::StepErrors Reference::step_errors(const Model& model, const StepInputs& inputs, const State& before,
                                             const State& after, OpenWorkspace& w) {
  const Minimum lowest = minimum(model, inputs, before, after.x, w);
  StepErrors errors;
  errors.motion = motion_error(model, before.x, w.y, after.x, lowest.x);
  w.trial.x = w.y;
  w.trial.contacts = w.current.contacts;
  evaluate(model, w, w.trial, Wanted::value);
  const double noise = 2 * noise_of(model, w.trial.g, before.x.cwiseAbs().maxCoeff());
  if (lowest.below_y > noise) errors.error = lowest.below_end / lowest.below_y;
  return errors;
}

}  // namespace supple
