#include "baselines/reference.h"

#include <limits>

namespace supple {

std::optional<double> step_error(const Model& model, const FrameInputs& inputs, const State& before, const State& after,
                                 const StepReport& report, Workspace& workspace) {
  SolverSettings solver;
  solver.iterations = 5000;
  solver.history = 20;
  workspace.prepare(model, solver);
  workspace.report = StepReport{};
  begin_step(model, inputs, before, workspace);
  workspace.x.topRows(model.free) = after.x.topRows(model.free);
  // A direction's slope bounds what it can still gain to within a small factor: 1e-6 of the digits that a reader of the error looks at.
  constexpr double digits = 1e-11;
  minimize(model, solver, workspace, digits * report.decrease);
  const double remaining = workspace.report.decrease;
  const double whole = report.decrease + remaining;
  const double noise = 64 * std::numeric_limits<double>::epsilon() * std::abs(report.objective.front());
  if (!(whole > noise)) return std::nullopt;
  return remaining / whole;
}

}  // namespace supple
