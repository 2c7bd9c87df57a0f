#include "sim/solver/more_rounds.h"

#include "sim/solver/energy_gain.h"
#include "sim/solver/newton_finish.h"

namespace supple {

bool needs_another_round(const StepContext& c, const Iterations& search, const SearchLimits& limits) {
  const SolverSettings& solver = c.inputs.solver;
  return search.end() == SearchEnd::iterations && limits.iterations < solver.rounds * solver.iterations &&
         gains_energy(c);
}

SearchLimits with_another_round(const StepContext& c, SearchLimits limits) {
  limits.iterations += c.inputs.solver.iterations;
  limits.trials = trials_before_newton(c, limits.iterations);
  return limits;
}

}  // namespace supple
