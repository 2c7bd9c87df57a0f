#include "sim/model/state.h"

#include "base/hash.h"
#include "base/trace.h"
#include "sim/model/flow_step.h"
#include "sim/model/model.h"

namespace supple {

State rest_state(const Model& model) {
  return {model.rest, Positions::Zero(model.vertices, 3), 0, {}, {}, rest_flow(model), {}};
}

Positions in_input_order(const Model& model, const Positions& rows) {
  Positions result(model.vertices, 3);
  for (int i = 0; i < model.vertices; ++i) result.row(model.input_of[i]) = rows.row(i);
  return result;
}

std::uint64_t state_hash(const Model& model, const State& state) {
  const Zone zone("hash");
  Positions both(2 * model.vertices, 3);
  both.topRows(model.vertices) = in_input_order(model, state.x);
  both.bottomRows(model.vertices) = in_input_order(model, state.v);
  if (state.flow.empty()) return hash_bytes(both.data(), sizeof(double) * both.size());
  std::vector<double> all(both.data(), both.data() + both.size());
  for (const std::vector<double>* list : {&state.flow.plastic, &state.flow.hardened, &state.flow.viscous})
    all.insert(all.end(), list->begin(), list->end());
  return hash_bytes(all.data(), sizeof(double) * all.size());
}

}  // namespace supple
