#include "sim/solver/objective.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "sim/elements/element_kernels.h"
#include "sim/linear/linear_kernels.h"
#include "sim/model/bending.h"
#include "sim/model/vertex_chunks.h"

namespace supple {

namespace {

// Returns w/2 (|p - c|^2 - |r - c|^2) = w/2 (p - r) . (p + r - 2 c), which keeps its digits when p is near r.
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

// Computes one vertex's share of g: of inertia, handles' springs, damping and bending.
struct VertexTerms {
  const Model& model;
  const OpenWorkspace& w;
  const double* point;
  const double* reference;  // or null
  double inertia;           // the time scheme's factor of inertia over h^2 [1/s^2]
  bool springs, damped;
  // Where the elastic energy is evaluated for the point, and for the reference: the same, or the middle of the step.
  // Null without bending.
  const double* place;
  const double* reference_place;           // or null
  double* bending_forces;                  // takes the forces of bending
  const double* reference_bending_forces;  // those at the reference
  BendingRoom& bent;                       // has the places; takes what find_bending() finds

  // Computes row v of beta/h L (p - q).
  void drag(int v, const double* p, double (&sum)[3]) const {
    for (double& s : sum) s = 0;
    for (std::int32_t k = model.damping.begin[v]; k < model.damping.begin[v + 1]; ++k) {
      const std::size_t at = 3 * std::size_t(model.damping.column[k]);
      for (int c = 0; c < 3; ++c) sum[c] += model.damping.value[k] * (p[at + c] - w.start_copy.data()[at + c]);
    }
  }

  // Adds what the damping of held vertices contributes to the value.
  void add_held_drag(double& value) const {
    for (int v = model.free; v < model.vertices; ++v) {
      double of_point[3];
      drag(v, point, of_point);
      for (int k = 0; k < 3; ++k) value += 0.5 * (point[3 * std::size_t(v) + k] - w.start_copy(v, k)) * of_point[k];
    }
  }

  // Writes the vertex's gradient; returns the value, or its difference from the reference's.
  double add(int v, double (&gradient)[3]) const {
    const std::size_t at = 3 * std::size_t(v);
    const double *p = point + at, *y = w.y.data() + at, *r = reference != nullptr ? reference + at : nullptr;
    const double weight = model.mass[v] * inertia;
    double value = r != nullptr ? quadratic_change(weight, p, r, y) : quadratic_value(weight, p, y);
    for (int c = 0; c < 3; ++c) gradient[c] = weight * (p[c] - y[c]);
    if (springs && model.handle_stiffness[v] > 0) value += add_spring(v, gradient);
    if (damped) value += add_drag(v, gradient);
    if (place == nullptr) return value;
    if (model.curvature.holds(v)) {
      add_curvature(v, gradient);
    } else {
      value += add_bending(v, gradient);
    }
    return value;
  }

  // Finds the forces of bending at the vertices from `first` to `end`, which add() needs.
  void find_bending(int first, int end) const {
    if (place == nullptr) return;
    const DifferenceRows rows{model.bending.begin.data(), model.bending.column.data(), model.bending.value.data()};
    double* squares = reference_place == nullptr ? bent.squares.data() : nullptr;
    const auto find = [&](int from, int to) {
      linear_kernels().difference_rows(rows, bent.places.data(), from, to, bent.forces.data(), squares);
    };
    if (model.curvature.empty()) return find(first, end);
    for (int v = first; v < end; ++v) {
      if (!model.curvature.holds(v)) find(v, v + 1);
    }
  }

  // Adds the bending of held vertices to the value, without a reference.
  void add_held_bending(double& value) const {
    find_bending(model.free, model.vertices);
    double unused[3];
    for (int v = model.free; v < model.vertices; ++v) {
      for (double& u : unused) u = 0;
      if (!model.curvature.holds(v)) value += add_bending(v, unused);
    }
  }

 private:
  // Adds the forces of bending that evaluate_rest_curvature() has found. They need no factor, because e theta = 1.
  void add_curvature(int v, double (&gradient)[3]) const {
    double slope[3];
    curvature_slope(model.curvature, w.curvature, v, slope);
    for (int c = 0; c < 3; ++c) gradient[c] += slope[c];
  }

  // Computes e/2 z^T Q z from the squared distances of the vertices that v is joined with, or for the difference e/2 (z
  // - r)^T Q (z + r), to which held vertices, where z = r, add nothing. The force needs no factor, because e theta = 1.
  double add_bending(int v, double (&gradient)[3]) const {
    const std::size_t at = 3 * std::size_t(v);
    const double* force = &bent.forces[4 * std::size_t(v)];
    for (int c = 0; c < 3; ++c) gradient[c] += force[c];
    if (v < model.free) {
      for (int c = 0; c < 3; ++c) bending_forces[at + c] = force[c];
    }
    if (reference_place == nullptr) return -0.25 * model.scheme.energy * bent.squares[std::size_t(v)];
    double value = 0;
    for (int c = 0; c < 3; ++c)
      value += (place[at + c] - reference_place[at + c]) * (force[c] + reference_bending_forces[at + c]);
    return 0.5 * model.scheme.energy * value;
  }

  double add_spring(int v, double (&gradient)[3]) const {
    const std::size_t at = 3 * std::size_t(v);
    const double theta = model.scheme.theta, *t = w.target.data() + at;
    const auto evaluated = [&](const double* x, double(&result)[3]) {
      for (int c = 0; c < 3; ++c)
        result[c] = theta < 1 ? theta * x[at + c] + (1 - theta) * w.start_copy.data()[at + c] : x[at + c];
    };
    double p[3], r[3];
    evaluated(point, p);
    for (int c = 0; c < 3; ++c) gradient[c] += model.handle_stiffness[v] * (p[c] - t[c]);
    const double weight = model.scheme.energy * model.handle_stiffness[v];
    if (reference == nullptr) return quadratic_value(weight, p, t);
    evaluated(reference, r);
    return quadratic_change(weight, p, r, t);
  }

  // Computes 1/2 (p-q)^T D (p-q), or for the difference 1/2 (p-r)^T D (p-q + r-q), to which held vertices, where p = r,
  // add nothing.
  double add_drag(int v, double (&gradient)[3]) const {
    const std::size_t at = 3 * std::size_t(v);
    double of_point[3], of_reference[3], value = 0;
    drag(v, point, of_point);
    if (reference != nullptr) drag(v, reference, of_reference);
    for (int c = 0; c < 3; ++c) {
      gradient[c] += of_point[c];
      value += reference != nullptr ? (point[at + c] - reference[at + c]) * (of_point[c] + of_reference[c])
                                    : (point[at + c] - w.start_copy.data()[at + c]) * of_point[c];
    }
    return 0.5 * value;
  }
};

// Computes energies and forces of all elements at `place`; returns e times the sum of energies, or of their differences
// from those of a reference (null: none).
double evaluate_elements(const Model& model, OpenWorkspace& workspace, const Positions& place,
                         AlignedVector<double>& energy, Wanted wanted, const AlignedVector<double>* reference) {
  const auto evaluate_chunk = workspace.elements == Precision::single_precision ? element_kernels().elements_single
                                                                                : element_kernels().elements;
  const int chunks = static_cast<int>(model.chunks.size());
  double* partial = workspace.partial.data();
  run_chunks(workspace.threads, chunks, long(model.elements) * 4, [&](int c) {
    const Model::ChunkRange& range = model.chunks[c];
    const std::size_t first = std::size_t(range.first_block) * block_width;
    partial[c] = evaluate_chunk(
        model.chunk(c), place.data(), reference != nullptr ? reference->data() + first : nullptr, energy.data() + first,
        wanted == Wanted::gradient ? workspace.force.data() + list_stride * std::size_t(range.first_vertex) : nullptr,
        workspace.local.data() + std::size_t(c) * model.largest_chunk * list_stride);
  });
  double sum = 0;
  for (int c = 0; c < chunks; ++c) sum += partial[c];
  return model.scheme.energy * sum;
}

// Computes the bending of cloth that is curved at rest, and its forces, at `place`; returns e times its energy, or the
// difference of the energy from a reference's (null: none).
double evaluate_rest_curvature(const Model& model, OpenWorkspace& workspace, const Positions& place,
                               std::vector<double>& energy, const std::vector<double>* reference) {
  evaluate_curvature(model.curvature, workspace.threads, place.data(), workspace.curvature, energy);
  double sum = 0;
  for (std::size_t t = 0; t < energy.size(); ++t) sum += reference != nullptr ? energy[t] - (*reference)[t] : energy[t];
  return model.scheme.energy * sum;
}

// Adds the vertices' terms, and gathers the whole gradient from these and the elements' forces.
void add_vertices(const Model& model, OpenWorkspace& workspace, const VertexTerms& terms, Positions* gradient,
                  Change& change) {
  const int chunks = vertex_chunks(model);
  double* partial = workspace.partial.data();
  run_chunks(workspace.threads, chunks, long(model.free) * (gradient != nullptr ? 6 : 2), [&](int c) {
    double value = 0, slope = 0;
    const int end = std::min(model.free, (c + 1) * vertices_a_chunk);
    terms.find_bending(c * vertices_a_chunk, end);
    for (int v = c * vertices_a_chunk; v < end; ++v) {
      double sum[3];
      value += terms.add(v, sum);
      if (gradient == nullptr) continue;
      // Elastic forces are added without a factor, because e theta = 1 for both integrators.
      for (std::int32_t s = model.slot_begin[v]; s < model.slot_begin[v + 1]; ++s) {
        const double* f = workspace.force.data() + list_stride * std::size_t(model.slots[s]);
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
}

// Says where seams are evaluated, n x 3: for a point and for a reference (null: none).
struct SewnPlaces {
  const double* place;
  const double* reference;
};

// Adds what neither an element nor a vertex alone has: air, seams, what held vertices do, and contacts.
void add_joint_terms(const Model& model, OpenWorkspace& workspace, const VertexTerms& terms, const SewnPlaces& sewn,
                     const Iterate& at, const std::vector<Contact>& planes, const Iterate* reference,
                     Positions* gradient, Change& change) {
  const Positions* reference_x = reference != nullptr ? &reference->x : nullptr;
  const auto add = [&change](const auto& part) {
    change.value += part.value;
    change.slope += part.slope;
  };
  if (workspace.air.act())
    add(workspace.air.add(model, workspace.threads, at.x, reference_x, workspace.direction, gradient));
  if (!model.seams.empty())
    add(add_seams(model, workspace.seam_gaps, sewn.place, sewn.reference, workspace.direction, gradient));
  if (terms.damped && reference == nullptr) terms.add_held_drag(change.value);
  if (terms.place != nullptr && reference == nullptr) terms.add_held_bending(change.value);
  if (!planes.empty()) add(add_contacts(planes, at.x, reference_x, workspace.direction, gradient));
}

// Computes g at an iterate with the contacts of `planes`, or its difference from g at a reference (null: none).
Change evaluate_against(const Model& model, OpenWorkspace& workspace, Iterate& at, const std::vector<Contact>& planes,
                        const Iterate* reference, Wanted wanted) {
  const TimedPhase timed(workspace.clock, Phase::evaluate, "evaluate");
  const double theta = model.scheme.theta;
  if (theta < 1) workspace.middle = theta * at.x + (1 - theta) * workspace.start_copy;
  Change change{evaluate_elements(model, workspace, theta < 1 ? workspace.middle : at.x, at.energy, wanted,
                                  reference != nullptr ? &reference->energy : nullptr),
                0};
  at.elastic = change.value + (reference != nullptr ? reference->elastic : 0);
  if (!model.curvature.empty())
    change.value += evaluate_rest_curvature(model, workspace, theta < 1 ? workspace.middle : at.x, at.curvature_energy,
                                            reference != nullptr ? &reference->curvature_energy : nullptr);
  Positions* gradient = wanted == Wanted::gradient ? &at.gradient : nullptr;
  const Positions* reference_x = reference != nullptr ? &reference->x : nullptr;
  const bool bends = !model.bending.begin.empty(), sewn = !model.seams.empty();
  if (bends) at.bending_forces.resize(model.free, 3);
  if ((bends || sewn) && theta < 1 && reference != nullptr)
    workspace.reference_middle = theta * reference->x + (1 - theta) * workspace.start_copy;
  const auto place_of = [&](const Positions& x, const Positions& middle) {
    return theta < 1 ? middle.data() : x.data();
  };
  const VertexTerms terms{model,
                          workspace,
                          at.x.data(),
                          reference != nullptr ? reference_x->data() : nullptr,
                          model.scheme.inertia / (model.time_step * model.time_step),
                          !model.handle_stiffness.empty(),
                          !model.damping.begin.empty(),
                          bends ? place_of(at.x, workspace.middle) : nullptr,
                          bends && reference != nullptr ? place_of(reference->x, workspace.reference_middle) : nullptr,
                          bends ? at.bending_forces.data() : nullptr,
                          bends && reference != nullptr ? reference->bending_forces.data() : nullptr,
                          workspace.bent};
  if (bends) workspace.bent.take(terms.place, model.vertices);
  add_vertices(model, workspace, terms, gradient, change);
  const SewnPlaces sewn_places{place_of(at.x, workspace.middle),
                               reference != nullptr ? place_of(reference->x, workspace.reference_middle) : nullptr};
  add_joint_terms(model, workspace, terms, sewn_places, at, planes, reference, gradient, change);
  return change;
}

}  // namespace

bool needs_start(const Model& model) { return model.scheme.theta < 1 || !model.damping.begin.empty(); }

void evaluate(const Model& model, OpenWorkspace& workspace, Iterate& iterate, Wanted wanted) {
  iterate.g = evaluate_against(model, workspace, iterate, iterate.contacts, nullptr, wanted).value;
}

Change evaluate_trial(const Model& model, OpenWorkspace& workspace, Wanted wanted) {
  const Change change =
      evaluate_against(model, workspace, workspace.trial, workspace.current.contacts, &workspace.current, wanted);
  workspace.trial.g = workspace.current.g + change.value;
  return change;
}

Change evaluate_trial_in_double(const Model& model, OpenWorkspace& workspace) {
  workspace.elements = Precision::double_precision;
  Change change =
      evaluate_against(model, workspace, workspace.trial, workspace.current.contacts, nullptr, Wanted::gradient);
  workspace.trial.g = change.value;
  change.value -= workspace.current.g;
  return change;
}

// Sums lose some eps of the objective itself. The positions lose more: a position's last bit, eps times its distance
// from the origin, strains an element by this length over its edge, and the stress does work on this strain. Over all
// elements, at random, this work grows with the square root of their energy times their mean stiffness. At rest only
// the energy of these strains themselves remains: with trace L, between 1/32 and 1/8 of (eps X)^2 trace L, and a
// hundred times that for stiff volumes.
double noise_of(const Model& model, double objective, double extent) {
  constexpr double epsilon = std::numeric_limits<double>::epsilon();
  const double last_bit = epsilon * extent;
  return epsilon * 32 * std::abs(objective) +
         last_bit * (4 * std::sqrt(2 * std::abs(objective) * model.mean_stiffness) +
                     4 * last_bit * model.mean_stiffness * model.elements);
}

// The strains of elements are rounded to single precision, and the stress does work on what is lost; over all elements,
// at random, this work grows with the square root of their energy times their mean stiffness. Energies themselves are
// rounded, too.
double single_noise_of(const Model& model, double elastic) {
  const double energy = std::abs(elastic), stiffness = model.strain_stiffness;
  return single_round_off *
         (energy + 4 * std::sqrt(2 * energy * stiffness / model.elements) + 4 * single_round_off * stiffness);
}

// The fields of an element are off by u, and so are its edges; so its F is off by 2 u, and the stress k e of a strain e
// does the work 2 u k V e. Over all elements, the sum of k V e is at most sqrt(2 E sum k V).
double single_bias_of(const Model& model, double elastic) {
  const double energy = std::abs(elastic);
  return 2 * single_round_off * (energy + std::sqrt(2 * energy * model.strain_stiffness));
}

double inertial_energy(const Model& model, const OpenWorkspace& workspace, const Positions& x) {
  const double inverse_h2 = model.scheme.inertia / (model.time_step * model.time_step);
  double sum = 0;
  for (int v = 0; v < model.free; ++v)
    sum += 0.5 * inverse_h2 * model.mass[v] * (x.row(v) - workspace.y.row(v)).squaredNorm();
  return sum;
}

double elastic_energy(const Model& model, OpenWorkspace& workspace, const Positions& x) {
  return evaluate_elements(model, workspace, x, workspace.trial.energy, Wanted::value, nullptr) / model.scheme.energy +
         bending_energy(model, x);
}

double work_on_held(const Model& model, OpenWorkspace& workspace, const Positions& x, const Positions& q) {
  double work = 0;
  for (int c = 0; c < static_cast<int>(model.chunks.size()); ++c) {
    const Model::ChunkRange& range = model.chunks[c];
    const std::span<const std::int32_t> vertices(&model.chunk_vertex[range.first_vertex], std::size_t(range.vertices));
    if (std::ranges::none_of(vertices, [&](std::int32_t v) { return v >= model.free; })) continue;
    double* force = workspace.force.data() + list_stride * std::size_t(range.first_vertex);
    element_kernels().elements(model.chunk(c), x.data(), nullptr,
                               workspace.trial.energy.data() + std::size_t(range.first_block) * block_width, force,
                               workspace.local.data());
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      const std::int32_t v = vertices[i];
      if (v < model.free) continue;
      for (int k = 0; k < 3; ++k) work += force[list_stride * i + k] * (x(v, k) - q(v, k));
    }
  }
  if (!model.curvature.empty()) evaluate_rest_curvature(model, workspace, x, workspace.trial.curvature_energy, nullptr);
  for (int v = model.bending.begin.empty() ? model.vertices : model.free; v < model.vertices; ++v) {
    double row[3];
    if (model.curvature.holds(v)) {
      curvature_slope(model.curvature, workspace.curvature, v, row);
    } else {
      bending_row(model.bending, x.data(), v, row);
    }
    for (int k = 0; k < 3; ++k) work += row[k] * (x(v, k) - q(v, k));
  }
  return model.seams.empty() ? work : work + seam_work_on_held(model, workspace.seam_gaps, x, q);
}

}  // namespace supple
