#include "sim/solver/newton_finish.h"

#include <algorithm>

#include "sim/solver/energy_gain.h"
#include "sim/solver/error_estimate.h"

namespace supple {

bool may_finish_by_newton(const Model& model, const StepInputs& inputs) {
  constexpr double most_cost = 200;
  const SolverSettings& solver = inputs.solver;
  if (!solver.newton || solver.rounds < 2 || solver.line_search == LineSearch::none) return false;
  if (solver.budget_ms > 0 || inputs.repeated_cuts || model.integrator != Integrator::backward_euler) return false;
  const bool solid = std::any_of(model.chunks.begin(), model.chunks.end(),
                                 [](const Model::ChunkRange& chunk) { return chunk.kind == ElementKind::tetrahedron; });
  return solid && newton_cost(model) <= most_cost;
}

namespace {

class NewtonDirections final : public SearchRule {
 public:
  double direction(const Model& model, const StepInputs& inputs, Workspace& workspace) override {
    return workspace.newton.direction(model, inputs, workspace);
  }
};

}  // namespace

bool finish_by_newton(const Model& model, const StepInputs& inputs, const Origin& origin, Workspace& w, bool hopeless) {
  constexpr double small_share = 1e-4, smaller_share = 1e-8;  // energy from nothing and turning need few of them
  constexpr int most_to_turn = 30;
  StepReport& report = w.report;
  const bool gains = gains_energy(model, inputs, origin.state, origin.above_start, w, true);
  const bool far_in_energy = hopeless || is_unsolved(report.error_estimate, report.iterations, report.line_search);
  const bool far_in_motion = inputs.solver.levels > 1 && is_unsolved(report);
  if (!gains && !far_in_energy && !far_in_motion) return false;
  const double gained = gained_in_all(model, inputs, w, report.decrease + origin.above_start);
  const double left = report.remaining_estimate;
  const int iterations = report.iterations;
  NewtonDirections newton;
  const bool turns = !gains && !far_in_energy;
  const int most = (inputs.solver.rounds - 1) * inputs.solver.iterations;
  Limits limits{turns ? std::min(most, most_to_turn) : most, 0,
                (gains || turns ? smaller_share : small_share) * gained};
  limits.finishing = true;
  run_iterations(model, inputs, w, newton, limits);
  report.newton_iterations = report.iterations;
  report.iterations += iterations;
  if (!(report.slope < 0)) {
    report.remaining_estimate = left;  // there was no direction downhill
  } else if (report.stop_reason == StopReason::iterations) {
    report.remaining_estimate = std::max(report.remaining_estimate, report.decrement);
  } else if (report.stop_reason != StopReason::target_error) {
    report.remaining_estimate = report.decrement;
  }
  report.error_estimate = error_at_end(model, inputs, w, report.decrease + origin.above_start);
  return true;
}

}  // namespace supple
