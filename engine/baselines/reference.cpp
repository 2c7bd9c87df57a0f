#include "baselines/reference.h"

#include <cmath>

namespace supple {

std::optional<double> step_error(const Model& model, const FrameInputs& inputs, const State& before, const State& after,
                                 Workspace& workspace) {
  FrameInputs thorough = inputs;
  thorough.solver = SolverSettings{};
  thorough.solver.iterations = 5000;
  thorough.solver.history = 20;
  thorough.solver.contact = inputs.solver.contact;
  thorough.solver.contact.direction = ContactDirection::low_rank;
  workspace.prepare(model, thorough.solver);
  workspace.report = StepReport{};
  begin_step(model, thorough, before, workspace);
  // g(y) - g(x_k), summed as a difference; y with its handles at their targets, whatever the solver started from. Each
  // point has the contacts that are found there.
  const double contacts_at_start = contact_energy_at(model, thorough, workspace.x, workspace);
  const double at_start = evaluate(model, workspace, workspace.x, workspace.energy, nullptr, nullptr, nullptr).value;
  workspace.trial.topRows(model.free) = after.x.topRows(model.free);
  double gained =
      -evaluate(model, workspace, workspace.trial, workspace.trial_energy, nullptr, &workspace.x, &workspace.energy)
           .value;
  gained += contacts_at_start - contact_energy_at(model, thorough, workspace.trial, workspace);

  workspace.x.swap(workspace.trial);
  // A direction's slope bounds what it can still gain to within a small factor; this is far below the digits that
  // anybody reads.
  constexpr double digits = 1e-11;
  minimize(model, thorough, workspace, digits * std::abs(gained));
  const double remaining = workspace.report.decrease;
  const double whole = gained + remaining;
  const double noise = 2 * noise_of(model, at_start, before.x.cwiseAbs().maxCoeff());
  if (!(whole > noise)) return std::nullopt;
  return remaining / whole;
}

}  // namespace supple
