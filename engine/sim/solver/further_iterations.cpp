#include "sim/solver/further_iterations.h"

#include <algorithm>

#include "sim/coarse/rest_moduli.h"
#include "sim/solver/energy_gain.h"
#include "sim/solver/error_estimate.h"
#include "sim/solver/newton_finish.h"

namespace supple {
namespace {

// Tells whether a step may go on because it is far from its minimum. In a step of several bodies, the worst of them
// would decide for all: with this rule, a pile of 20 took twice the time in the mean. Cloth that flutters or lies in
// folds is far after thirty iterations, too. A material that is loose at rest enlarges small differences, also that
// between a body that passes a bound and one that does not: turned copies came apart. The paper's method with its one
// level makes the paper's iterations.
bool may_go_on(const StepContext& c) {
  const SolverSettings& solver = c.inputs.solver;
  return c.model.parts.size() == 1 && c.model.parts[0].solid && solver.levels > 1 && solver.target_error == 0 &&
         solver.line_search != LineSearch::none && !has_time_budget(c.inputs) &&
         c.model.integrator == Integrator::backward_euler && c.rule.measures_last_iterate() &&
         !has_loose_material(c.model);
}

}  // namespace

int further_iterations(const StepContext& c, const Iterations& search, const SearchLimits& limits) {
  constexpr int few = 2;          // iterations between two looks at how far the body is
  constexpr int most_rounds = 3;  // for a body that is far; with five, one that is pressed flat takes twice the time
  const SolverSettings& solver = c.inputs.solver;
  const int room = solver.rounds * solver.iterations - limits.iterations;
  if (search.end() != SearchEnd::iterations || room <= 0) return 0;
  if (gains_energy(c)) return std::min(solver.iterations, room);
  const int left = std::min(room, most_rounds * solver.iterations - limits.iterations);
  if (left <= 0 || !may_go_on(c)) return 0;
  const bool has_gone_on = limits.iterations > solver.iterations;
  return is_far(c.model, c.inputs, c.state.x, has_gone_on, c.w) ? std::min(few, left) : 0;
}

SearchLimits with_more(const StepContext& c, SearchLimits limits, int iterations) {
  limits.iterations += iterations;
  limits.trials = trials_before_newton(c, limits.iterations);
  return limits;
}

}  // namespace supple
