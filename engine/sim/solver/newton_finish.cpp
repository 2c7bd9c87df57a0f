#include "sim/solver/newton_finish.h"

#include <algorithm>

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

}  // namespace supple
