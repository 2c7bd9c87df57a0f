#include "sim/solver/objective.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/trace.h"

namespace supple {

void Workspace::prepare(const Model& model, const SolverSettings& solver) {
  const std::size_t most_values = 2 * (std::size_t(solver.iterations) + 1);  // a step may descend twice
  if (report.objective.capacity() < most_values) report.objective.reserve(most_values);
  if (report.history.capacity() < most_values) report.history.reserve(most_values);
  if (prepared_for_ == model.id && window_ >= solver.history) return;
  if (prepared_for_ != model.id) correction = {};
  prepared_for_ = model.id;
  window_ = std::max(window_, solver.history);
  y.resize(model.vertices, 3);
  x.resize(model.vertices, 3);
  trial.resize(model.vertices, 3);
  q.resize(needs_start(model) ? model.vertices : 0, 3);
  middle.resize(model.scheme.theta < 1 ? model.vertices : 0, 3);
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

// One vertex' share of w M/h^2, handles' springs and damping.
struct VertexTerms {
  const Model& model;
  const Workspace& w;
  const double* point;
  const double* reference;  // or null
  double inertia;           // w / h^2 [1/s^2]
  bool springs, damped;

  // Row v of beta/h L (p - q).
  void drag(int v, const double* p, double (&sum)[3]) const {
    for (double& s : sum) s = 0;
    for (std::int32_t k = model.damping.begin[v]; k < model.damping.begin[v + 1]; ++k) {
      const std::size_t at = 3 * std::size_t(model.damping.column[k]);
      for (int c = 0; c < 3; ++c) sum[c] += model.damping.value[k] * (p[at + c] - w.q.data()[at + c]);
    }
  }

  // Adds the gradient; returns the value, or its difference from the reference's.
  double add(int v, double (&gradient)[3]) const {
    const std::size_t at = 3 * std::size_t(v);
    const double *p = point + at, *y = w.y.data() + at, *r = reference != nullptr ? reference + at : nullptr;
    const double weight = model.mass[v] * inertia;
    double value = r != nullptr ? quadratic_change(weight, p, r, y) : quadratic_value(weight, p, y);
    for (int c = 0; c < 3; ++c) gradient[c] = weight * (p[c] - y[c]);
    if (springs && model.spring[v] > 0) value += add_spring(v, gradient);
    if (damped) value += add_drag(v, gradient);
    return value;
  }

 private:
  double add_spring(int v, double (&gradient)[3]) const {
    const std::size_t at = 3 * std::size_t(v);
    const double theta = model.scheme.theta, *t = w.target.data() + at;
    const auto evaluated = [&](const double* x, double(&result)[3]) {
      for (int c = 0; c < 3; ++c)
        result[c] = theta < 1 ? theta * x[at + c] + (1 - theta) * w.q.data()[at + c] : x[at + c];
    };
    double p[3], r[3];
    evaluated(point, p);
    for (int c = 0; c < 3; ++c) gradient[c] += model.spring[v] * (p[c] - t[c]);
    const double weight = model.scheme.energy * model.spring[v];
    if (reference == nullptr) return quadratic_value(weight, p, t);
    evaluated(reference, r);
    return quadratic_change(weight, p, r, t);
  }

  // 1/2 (p-q)^T D (p-q), or 1/2 (p-r)^T D (p-q + r-q) for the difference: held vertices, where p = r, drop out of it.
  double add_drag(int v, double (&gradient)[3]) const {
    const std::size_t at = 3 * std::size_t(v);
    double of_point[3], of_reference[3], value = 0;
    drag(v, point, of_point);
    if (reference != nullptr) drag(v, reference, of_reference);
    for (int c = 0; c < 3; ++c) {
      gradient[c] += of_point[c];
      value += reference != nullptr ? (point[at + c] - reference[at + c]) * (of_point[c] + of_reference[c])
                                    : (point[at + c] - w.q.data()[at + c]) * of_point[c];
    }
    return 0.5 * value;
  }
};

// Energies and forces of all elements; returns e times the sum of energies, or of their differences.
double evaluate_elements(const Model& model, Workspace& workspace, const Positions& point,
                         AlignedVector<double>& energy, bool with_force,
                         const AlignedVector<double>* reference_energy) {
  const ElementKernels& kernel = element_kernels();
  const int chunks = static_cast<int>(model.chunks.size());
  double* partial = workspace.partial.data();
  run_chunks(workspace, chunks, long(model.elements) * 4, [&](int c) {
    const Model::ChunkRange& range = model.chunks[c];
    const std::size_t first = std::size_t(range.first_block) * block_width;
    partial[c] = kernel.elements(
        model.chunk(c), point.data(), reference_energy != nullptr ? reference_energy->data() + first : nullptr,
        energy.data() + first, with_force ? workspace.force.data() + 3 * std::size_t(range.first_vertex) : nullptr,
        workspace.local.data() + std::size_t(c) * model.largest_chunk * 3);
  });
  double sum = 0;
  for (int c = 0; c < chunks; ++c) sum += partial[c];
  return model.scheme.energy * sum;
}

}  // namespace

// What round-off hides in a difference of objectives. Sums lose some eps of the objective itself. More is lost before:
// a position's last bit, eps times its distance from the origin, strains an element by that over its edge, and the
// stress works on it; over all elements, at random, that is the square root of their energy times their mean stiffness.
double noise_of(const Model& model, double objective, double extent) {
  return std::numeric_limits<double>::epsilon() *
         (32 * std::abs(objective) + 4 * extent * std::sqrt(2 * std::abs(objective) * model.mean_stiffness));
}

double elastic_energy(const Model& model, Workspace& workspace, const Positions& x) {
  return evaluate_elements(model, workspace, x, workspace.trial_energy, false, nullptr) / model.scheme.energy;
}

bool needs_start(const Model& model) { return model.scheme.theta < 1 || !model.damping.begin.empty(); }

Change evaluate(const Model& model, Workspace& workspace, const Positions& point, AlignedVector<double>& energy,
                Positions* gradient, const Positions* reference, const AlignedVector<double>* reference_energy) {
  const Zone zone("evaluate");
  const double theta = model.scheme.theta;
  if (theta < 1) workspace.middle = theta * point + (1 - theta) * workspace.q;
  Change change{evaluate_elements(model, workspace, theta < 1 ? workspace.middle : point, energy, gradient != nullptr,
                                  reference_energy),
                0};

  const int chunks = vertex_chunks(model);
  const VertexTerms terms{model,
                          workspace,
                          point.data(),
                          reference != nullptr ? reference->data() : nullptr,
                          model.scheme.inertia / (model.time_step * model.time_step),
                          !model.spring.empty(),
                          !model.damping.begin.empty()};
  double* partial = workspace.partial.data();
  run_chunks(workspace, chunks, long(model.free) * (gradient != nullptr ? 6 : 2), [&](int c) {
    double value = 0, slope = 0;
    const int end = std::min(model.free, (c + 1) * vertices_a_chunk);
    for (int v = c * vertices_a_chunk; v < end; ++v) {
      double sum[3];
      value += terms.add(v, sum);
      if (gradient == nullptr) continue;
      // Elastic forces as they are: e theta = 1 for both integrators.
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
  if (terms.damped && reference == nullptr) {  // what held vertices add to the value
    for (int v = model.free; v < model.vertices; ++v) {
      double of_point[3];
      terms.drag(v, point.data(), of_point);
      for (int k = 0; k < 3; ++k) change.value += 0.5 * (point(v, k) - workspace.q(v, k)) * of_point[k];
    }
  }
  if (!workspace.contact.found.empty()) {
    const ContactChange contacts = add_contacts(workspace.contact.found, workspace.contact.stick_length, point,
                                                reference, workspace.direction, gradient);
    change.value += contacts.value;
    change.slope += contacts.slope;
  }
  return change;
}

}  // namespace supple
