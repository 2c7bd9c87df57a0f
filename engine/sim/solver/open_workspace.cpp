#include "sim/solver/open_workspace.h"

#include <algorithm>

#include "sim/elements/element_kernels.h"
#include "sim/model/vertex_chunks.h"
#include "sim/solver/objective.h"

namespace supple {

void OpenWorkspace::prepare(const Model& model, const SolverSettings& solver) {
  // A step may go on for all of its rounds, make a second search, and be finished by as many iterations of Newton's
  // method.
  const std::size_t most_values = 2 * (std::size_t(solver.rounds) + 1) * (std::size_t(solver.iterations) + 1);
  if (report.objective.capacity() < most_values) report.objective.reserve(most_values);
  if (report.records.capacity() < most_values) report.records.reserve(most_values);
  if (prepared_for_ == model.id && window_ >= solver.history && (solver.levels < 2 || bow.rows() == model.free)) return;
  if (prepared_for_ != model.id) correction = {};
  prepared_for_ = model.id;
  window_ = std::max(window_, solver.history);
  y.resize(model.vertices, 3);
  for (Iterate* iterate : {&current, &trial}) {
    iterate->x.resize(model.vertices, 3);
    iterate->gradient.resize(model.free, 3);
    iterate->energy.resize(std::size_t(model.blocks) * block_width);
    iterate->contacts.clear();
  }
  start_copy.resize(needs_start(model) ? model.vertices : 0, 3);
  middle.resize(model.scheme.theta < 1 ? model.vertices : 0, 3);
  if (!model.handle_stiffness.empty()) target.resize(model.free, 3);
  direction.resize(model.free, 3);
  if (solver.levels > 1) {
    turning.prepare(model);
    motion.resize(model.vertices, 3);
    turned.resize(model.free, 3);
    bow.resize(model.free, 3);
  }
  scratch.resize(model.free, 3);
  force.resize(model.chunk_vertex.size() * list_stride);
  local.resize(std::size_t(model.chunks.size()) * model.largest_chunk * list_stride);
  solve_scratch.resize(model.factor.scratch_numbers());
  const std::size_t chunks = std::max<std::size_t>(model.chunks.size(), vertex_chunks(model));
  partial.resize(chunks * (2 * window_ + 4));
  step_pairs.resize(window_);
  gradient_pairs.resize(window_);
  for (Positions& pair : step_pairs) pair.resize(model.free, 3);
  for (Positions& pair : gradient_pairs) pair.resize(model.free, 3);
  products.resize(std::size_t(window_) * window_);
}

}  // namespace supple
