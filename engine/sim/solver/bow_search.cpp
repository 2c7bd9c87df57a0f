#include "sim/solver/bow_search.h"

#include "sim/solver/total_momentum.h"

namespace supple {

void bow_search(const Model& model, const StepInputs& inputs, double slope, OpenWorkspace& w) {
  constexpr double small_share = 0.02;
  w.is_bowed = false;
  if (!w.second_level_serves) return;
  const TimedPhase timed(w.clock, Phase::solve, "turn");
  if (w.second_level.system().most_stretched(model, w.direction) < small_share * -slope) return;
  w.turning.take_tangent(w.second_level.system(), w.current.x, w.direction);
  w.is_bowed = w.turning.energy() > small_share * -slope;
  if (!w.is_bowed) return;
  w.turning.correct(model, w.second_level.system(), w.current.x, w.solve_scratch, w.bow);
  keep_bow_on_planes(model, inputs.solver.contact, w.current.contacts, w.current.x, w.direction, w.correction, w.bow);
  if (is_isolated(model, w, w.current.contacts)) take_out_translation(model, w.bow);
}

}  // namespace supple
