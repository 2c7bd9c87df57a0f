#include "sim/solver/step_problem.h"

#include "base/error.h"
#include "sim/solver/begin_step.h"

namespace supple {

StepProblem problem_of(const BodyDescription& body, const Model& model, const StepInputs& inputs, const State& state) {
  SUPPLE_CHECK(body.mesh.rest.rows(), ==, model.vertices);
  SUPPLE_CHECK(inputs.targets.rows(), ==, Eigen::Index(model.handled.size()));
  StepProblem problem;
  problem.body = body;
  for (const SystemStiffness& stiffness : model.stiffness) problem.stiffness.push_back(stiffness.k);
  problem.mass.resize(model.vertices);
  for (int i = 0; i < model.vertices; ++i) problem.mass[model.input_of[i]] = model.mass[i];
  problem.time = state.time;
  problem.gravity = inputs.gravity;
  Positions y;
  inertial_prediction(model, inputs, state, y);
  problem.q = in_input_order(model, state.x);
  problem.v = in_input_order(model, state.v);
  problem.y = in_input_order(model, y);
  problem.hash = state_hash(model, state);
  problem.began_in_single = state.memory.began_in_single;
  problem.solver = inputs.solver;
  std::vector<Eigen::Index> rows;  // those of `targets` whose handles hold
  for (std::size_t i = 0; i < model.handled.size(); ++i) {
    const Handle& handle = body.handles[model.handled[i].handle];
    if (!handle.holds) continue;
    rows.push_back(static_cast<Eigen::Index>(i));
    problem.handled.push_back({model.input_of[model.handled[i].vertex], handle.stiffness});
  }
  problem.targets = inputs.targets(rows, Eigen::all);
  if (model.scheme.theta < 1) problem.middle_targets = inputs.middle_targets(rows, Eigen::all);
  Positions gaps;
  open_gaps(model, inputs.seams, model.scheme.theta < 1 ? &SeamOpening::middle : &SeamOpening::end, gaps);
  for (std::size_t p = 0; p < model.seams.pairs.size(); ++p) {
    SeamPair& pair = problem.seams.emplace_back(model.seams.pairs[p]);
    pair.gap = gaps.row(Eigen::Index(p));
    for (std::int32_t& v : pair.vertex) v = model.input_of[v];
  }
  for (std::size_t c = 0; has_colliders(inputs) && c < inputs.colliders->size(); ++c) {
    const Collider& collider = (*inputs.colliders)[c];
    problem.colliders.push_back({collider.name, collider.thickness, collider.friction, inputs.collider_motions[c]});
  }
  return problem;
}

}  // namespace supple
