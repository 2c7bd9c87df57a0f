#include "sim/solver/newton_finish.h"

#include <algorithm>
#include <limits>

#include "sim/elements/element.h"
#include "sim/solver/energy_gain.h"
#include "sim/solver/error_estimate.h"
#include "sim/solver/iterations.h"

namespace supple {

bool may_finish_by_newton(const Model& model, const StepInputs& inputs) {
  constexpr double most_cost = 200;
  const SolverSettings& solver = inputs.solver;
  if (model.parts.size() > 1) return false;  // the matrix has no room for contacts between parts
  if (!solver.newton || solver.rounds < 2 || solver.line_search == LineSearch::none) return false;
  if (has_time_budget(inputs) || model.integrator != Integrator::backward_euler) return false;
  const bool solid = std::any_of(model.chunks.begin(), model.chunks.end(),
                                 [](const Model::ChunkRange& chunk) { return chunk.kind == ElementKind::tetrahedron; });
  return solid && newton_cost(model) <= most_cost;
}

namespace {

class NewtonDirections final : public SearchRule {
 public:
  double direction(const Model& model, const StepInputs& inputs, OpenWorkspace& workspace) override {
    return workspace.newton.direction(model, inputs, workspace);
  }
};

// Returns where Newton's method ends. gained: what the step has gained [J].
SearchLimits limits_of(const StepContext& c, Hardness hardness, double gained) {
  constexpr double small_share = 1e-4,
                   smaller_share = 1e-8;  // the smaller one: energy from nothing and turning need it
  constexpr int most_to_turn = 30;        // iterations; a stiff cube that hits a post beside its middle needs some 20
  const int most = (c.inputs.solver.rounds - 1) * c.inputs.solver.iterations;
  return {.iterations = hardness == Hardness::far_in_motion ? std::min(most, most_to_turn) : most,
          .enough = (hardness == Hardness::far_in_energy ? small_share : smaller_share) * gained,
          .least_iterations = 1,
          .worse_iterate = WorseIterate::refused};
}

// Writes an estimate of what is left after Newton's method into the report. before: the gain that was left before [J].
void estimate_what_is_left(double before, StepReport& report) {
  if (!(report.slope < 0)) {
    report.remaining_estimate = before;  // no direction led downhill
  } else if (report.stop_reason == StopReason::iterations) {
    report.remaining_estimate = std::max(report.remaining_estimate, report.decrement);
  } else if (report.stop_reason != StopReason::target_error) {
    report.remaining_estimate = report.decrement;
  }
}

// Returns how many times the way ahead, which is that of the last direction, is left to go. Directions of Newton's
// method that hardly shrink point the same way, in which the projected Hessian is too stiff: their lengths are a
// geometric series.
double times_to_go(const StepReport& report) {
  constexpr double slowest = 0.95;
  if (report.newton_iterations < 2 || report.records.size() < 2) return 1;
  const double last = report.records.back().decrease, before = report.records[report.records.size() - 2].decrease;
  if (!(last > 0) || !(before > 0)) return 1;
  return 1 / (1 - std::min(slowest, std::sqrt(last / before)));
}

}  // namespace

int trials_before_newton(const StepContext& c, int iterations) {
  return may_finish_by_newton(c.model, c.inputs) ? most_trials_an_iteration * iterations
                                                 : std::numeric_limits<int>::max();
}

Hardness hardness_of(const StepContext& c) {
  const StepReport& report = c.w.report;
  if (report.failed || report.stop_reason == StopReason::still) return Hardness::none;
  if (!may_finish_by_newton(c.model, c.inputs)) return Hardness::none;
  if (gains_energy(c)) return Hardness::gains_energy;
  if (c.gave_up || is_unsolved(report.error_estimate, report.iterations, report.line_search))
    return Hardness::far_in_energy;
  // With one level, as in the paper, nearly every step of a stiff body would be hard by its motion.
  const bool is_off = is_unsolved(report.motion_ahead, report.iterations, 0);
  return c.inputs.solver.levels > 1 && is_off ? Hardness::far_in_motion : Hardness::none;
}

void finish_by_newton(StepContext& c, Hardness hardness) {
  OpenWorkspace& w = c.w;
  StepReport& report = w.report;
  const double gained = gained_in_all(c.model, c.inputs, w, report.decrease + c.above_start);
  const double left = report.remaining_estimate;
  const int iterations = report.iterations;
  NewtonDirections newton;
  run_search(c.model, c.inputs, w, newton, limits_of(c, hardness, gained));
  report.newton_iterations = report.iterations;
  report.iterations += iterations;
  estimate_what_is_left(left, report);
  report.error_estimate = error_at_end(c.model, c.inputs, w, report.decrease + c.above_start);
  // Newton's method that ran out of iterations does not know how far it still was.
  const double before = report.stop_reason == StopReason::iterations ? report.motion_estimate : 0;
  report.motion_estimate = std::max(before, motion_estimate(c.model, c.inputs, c.state.x, w, times_to_go(report)));
}

}  // namespace supple
