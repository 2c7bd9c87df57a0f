#include "sim/objective.h"

#include <algorithm>

namespace supple {

void Workspace::prepare(const Model& model, const SolverSettings& solver) {
  const std::size_t most_values = 2 * (std::size_t(solver.iterations) + 1);  // a step may descend twice
  if (report.objective.capacity() < most_values) report.objective.reserve(most_values);
  if (prepared_for_ == &model && window_ >= solver.history) return;
  prepared_for_ = &model;
  window_ = std::max(window_, solver.history);
  y.resize(model.vertices, 3);
  x.resize(model.vertices, 3);
  trial.resize(model.vertices, 3);
  if (!model.spring.empty()) target.resize(model.free, 3);
  gradient.resize(model.free, 3);
  trial_gradient.resize(model.free, 3);
  direction.resize(model.free, 3);
  energy.resize(std::size_t(model.blocks) * block_width);
  trial_energy.resize(energy.size());
  force.resize(model.chunk_vertex.size() * 3);
  local.resize(std::size_t(model.chunks.size()) * model.largest_chunk * 3);
  solve_scratch.resize(std::size_t(model.free) * 4);
  const std::size_t chunks = std::max<std::size_t>(model.chunks.size(), vertex_chunks(model));
  partial.resize(chunks * (2 * window_ + 4));
  step_pairs.resize(window_);
  gradient_pairs.resize(window_);
  for (Positions& pair : step_pairs) pair.resize(model.free, 3);
  for (Positions& pair : gradient_pairs) pair.resize(model.free, 3);
  products.resize(std::size_t(window_) * window_);
}

namespace {

// w/2 (|p - c|^2 - |r - c|^2) = w/2 (p - r) . (p + r - 2 c), which keeps its digits when p is near r.
double quadratic_change(double weight, const double* point, const double* reference, const double* center) {
  double sum = 0;
  for (int c = 0; c < 3; ++c) sum += (point[c] - reference[c]) * (point[c] + reference[c] - 2 * center[c]);
  return 0.5 * weight * sum;
}

double quadratic_value(double weight, const double* point, const double* center) {
  double sum = 0;
  for (int c = 0; c < 3; ++c) sum += (point[c] - center[c]) * (point[c] - center[c]);
  return 0.5 * weight * sum;
}

}  // namespace

Change evaluate(const Model& model, Workspace& workspace, const Positions& point, AlignedVector<double>& energy,
                Positions* gradient, const Positions* reference, const AlignedVector<double>* reference_energy) {
  const Kernels& kernel = kernels();
  const int element_chunks = static_cast<int>(model.chunks.size());
  double* partial = workspace.partial.data();
  run_chunks(workspace, element_chunks, long(model.elements) * 4, [&](int c) {
    const Model::ChunkRange& range = model.chunks[c];
    const std::size_t first = std::size_t(range.first_block) * block_width;
    partial[c] =
        kernel.elements(model.chunk(c), point.data(),
                        reference_energy != nullptr ? reference_energy->data() + first : nullptr, energy.data() + first,
                        gradient != nullptr ? workspace.force.data() + 3 * std::size_t(range.first_vertex) : nullptr,
                        workspace.local.data() + std::size_t(c) * model.largest_chunk * 3);
  });
  Change change{0, 0};
  for (int c = 0; c < element_chunks; ++c) change.value += partial[c];

  const int chunks = vertex_chunks(model);
  const double inverse_h2 = 1 / (model.time_step * model.time_step);
  const bool springs = !model.spring.empty();
  run_chunks(workspace, chunks, long(model.free) * (gradient != nullptr ? 6 : 2), [&](int c) {
    double value = 0, slope = 0;
    const int end = std::min(model.free, (c + 1) * vertices_a_chunk);
    for (int v = c * vertices_a_chunk; v < end; ++v) {
      const double* p = point.data() + 3 * std::size_t(v);
      const double* y = workspace.y.data() + 3 * std::size_t(v);
      const double weight = model.mass[v] * inverse_h2;
      const double* r = reference != nullptr ? reference->data() + 3 * std::size_t(v) : nullptr;
      value += r != nullptr ? quadratic_change(weight, p, r, y) : quadratic_value(weight, p, y);
      const double stiffness = springs ? model.spring[v] : 0;
      const double* t = springs ? workspace.target.data() + 3 * std::size_t(v) : nullptr;
      if (stiffness > 0)
        value += r != nullptr ? quadratic_change(stiffness, p, r, t) : quadratic_value(stiffness, p, t);
      if (gradient == nullptr) continue;
      double sum[3];
      for (int k = 0; k < 3; ++k) sum[k] = weight * (p[k] - y[k]);
      if (stiffness > 0) {
        for (int k = 0; k < 3; ++k) sum[k] += stiffness * (p[k] - t[k]);
      }
      for (std::int32_t s = model.slot_begin[v]; s < model.slot_begin[v + 1]; ++s) {
        const double* f = workspace.force.data() + 3 * std::size_t(model.slots[s]);
        for (int k = 0; k < 3; ++k) sum[k] += f[k];
      }
      double* g = gradient->data() + 3 * std::size_t(v);
      const double* d = workspace.direction.data() + 3 * std::size_t(v);
      for (int k = 0; k < 3; ++k) {
        g[k] = sum[k];
        slope += sum[k] * d[k];
      }
    }
    partial[2 * c] = value;
    partial[2 * c + 1] = slope;
  });
  for (int c = 0; c < chunks; ++c) {
    change.value += partial[2 * c];
    change.slope += partial[2 * c + 1];
  }
  return change;
}

}  // namespace supple
