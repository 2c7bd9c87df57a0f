#include "baselines/reference.h"

#include <cmath>

namespace supple {

std::optional<double> step_error(const Model& model, const FrameInputs& inputs, const State& before, const State& after,
                                 Workspace& workspace) {
  SolverSettings solver;
  solver.iterations = 5000;
  solver.history = 20;
  workspace.prepare(model, solver);
  workspace.report = StepReport{};
  begin_step(model, inputs, before, workspace);
  // g(y) - g(x_k), summed as a difference; y with its handles at their targets, whatever the solver started from.
  const double at_start = evaluate(model, workspace, workspace.x, workspace.energy, nullptr, nullptr, nullptr).value;
  workspace.trial.topRows(model.free) = after.x.topRows(model.free);
  const double gained =
      -evaluate(model, workspace, workspace.trial, workspace.trial_energy, nullptr, &workspace.x, &workspace.energy)
           .value;

  workspace.x.swap(workspace.trial);
  // A direction's slope bounds what it can still gain to within a small factor; this is far below the digits that
  // anybody reads.
  constexpr double digits = 1e-11;
  minimize(model, solver, workspace, digits * std::abs(gained));
  const double remaining = workspace.report.decrease;
  const double whole = gained + remaining;
  const double noise = 2 * noise_of(model, at_start, before.x.cwiseAbs().maxCoeff());
  if (!(whole > noise)) return std::nullopt;
  return remaining / whole;
}

}  // namespace supple
