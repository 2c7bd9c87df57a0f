#include "sim/model/model_values.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>

#include "base/error.h"
#include "sim/elements/element_kernels.h"
#include "sim/model/bending.h"

namespace supple {
namespace {

// Converts corners to the model's numbering and sorts elements into the order in which they are packed: by kind and
// region, then by first vertex.
void sort_elements(const Model& model, std::vector<ElementRecord>& elements) {
  for (ElementRecord& element : elements) {
    for (int k = 0; k < corners_of(element.kind); ++k) element.corner[k] = model.internal_of[element.corner[k]];
  }
  const auto key = [](const ElementRecord& e) {
    const auto end = e.corner.begin() + corners_of(e.kind);
    return std::tuple(e.kind, e.is_arm, e.region, *std::min_element(e.corner.begin(), end), e.input);
  };
  std::sort(elements.begin(), elements.end(),
            [&](const ElementRecord& a, const ElementRecord& b) { return key(a) < key(b); });
}

// Returns the pattern of L over all vertices, both triangles, diagonal included.
Eigen::SparseMatrix<double> pattern_of(const Model& model, const std::vector<ElementRecord>& elements,
                                       const Eigen::SparseMatrix<double>& bending) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(elements.size() * 16 + model.vertices);
  for (int v = 0; v < model.vertices; ++v) entries.emplace_back(v, v, 0.0);
  for (const ElementRecord& element : elements) {
    for (int a = 0; a < corners_of(element.kind); ++a) {
      for (int b = 0; b < corners_of(element.kind); ++b)
        entries.emplace_back(element.corner[a], element.corner[b], 0.0);
    }
  }
  for (int column = 0; column < bending.outerSize(); ++column) {
    for (Eigen::SparseMatrix<double>::InnerIterator entry(bending, column); entry; ++entry)
      entries.emplace_back(static_cast<int>(entry.row()), column, 0.0);
  }
  for (const SeamPair& pair : model.seams.pairs)
    pair.for_each_entry([&](std::int32_t row, std::int32_t column, double) { entries.emplace_back(row, column, 0.0); });
  Eigen::SparseMatrix<double> matrix(model.vertices, model.vertices);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

// Returns the elements of a body, in the numbering of its mesh. Where it creeps, the Maxwell arms of its tetrahedra
// come last; the volume of each tetrahedron, and with it all that it adds to sums, is shared with its arm.
std::vector<ElementRecord> records_of(const BodyDescription& body) {
  std::vector<ElementRecord> records = element_records(body.mesh, body.springs, body.cloth);
  if (!body.creep) return records;
  SUPPLE_CHECK(body.springs.size() + body.cloth.size(), ==, std::size_t(0));
  const std::size_t count = records.size();
  for (std::size_t e = 0; e < count; ++e) {
    ElementRecord arm = records[e];
    arm.is_arm = true;
    arm.field[9] *= body.creep->share;
    records[e].field[9] *= 1 - body.creep->share;
    records.push_back(arm);
  }
  return records;
}

// Writes the volumes of elements and of their arms into the packed fields.
void set_arm_shares(Model& model, const TetMesh& mesh) {
  if (!model.creep) return;
  for (const Model::ChunkRange& chunk : model.chunks) {
    const double share = chunk.is_arm ? model.creep->share : 1 - model.creep->share;
    for (int place = 0; place < chunk.blocks * block_width; ++place) {
      const std::size_t block = place / block_width, lane = place % block_width;
      const std::int32_t input = model.element_of_lane[std::size_t(chunk.first_block) * block_width + place];
      if (input < 0) continue;  // padding has no weight
      model.field[chunk.first_field + (block * Tetrahedron::fields + 9) * block_width + lane] =
          share * tet_volume(mesh, input);
    }
  }
}

// Writes the lengths at rest and the stiffness of springs into the packed fields.
void set_spring_fields(Model& model, const std::vector<Spring>& springs) {
  for (const Model::ChunkRange& chunk : model.chunks) {
    if (chunk.kind != ElementKind::spring) continue;
    for (int place = 0; place < chunk.blocks * block_width; ++place) {
      const std::size_t block = place / block_width, lane = place % block_width;
      const std::int32_t input = model.element_of_lane[std::size_t(chunk.first_block) * block_width + place];
      if (input < 0) continue;  // padding has no weight
      double* field = &model.field[chunk.first_field + block * SpringElement::fields * block_width + lane];
      field[0] = springs[input].length;
      field[block_width] = springs[input].stiffness;
    }
  }
}

void set_masses(Model& model, const BodyDescription& body) {
  model.mass.assign(model.vertices, 0.0);
  for (Eigen::Index e = 0; e < body.mesh.tets.rows(); ++e) {
    const double quarter = body.density * tet_volume(body.mesh, e) / 4;
    for (int k = 0; k < 4; ++k) model.mass[model.internal_of[body.mesh.tets(e, k)]] += quarter;
  }
  if (!body.point_mass.empty()) SUPPLE_CHECK(body.point_mass.size(), ==, std::size_t(model.vertices));
  for (std::size_t v = 0; v < body.point_mass.size(); ++v) model.mass[model.internal_of[v]] += body.point_mass[v];
  model.total_mass = 0;
  for (Part& part : model.parts) {
    const auto first = model.mass.begin() + part.first_free;
    part.mass = std::accumulate(first, first + part.free, 0.0);
    model.total_mass += part.mass;
  }
}

void set_handle_springs(Model& model, const BodyDescription& body) {
  model.handle_stiffness.clear();
  for (Part& part : model.parts) part.floats = part.held == 0;
  for (auto& [vertex, h, holds] : model.handled) {
    const Handle& handle = body.handles[h];
    holds = handle.holds;
    if (handle.stiffness <= 0) continue;
    if (model.handle_stiffness.empty()) model.handle_stiffness.assign(model.free, 0.0);
    if (!holds) continue;
    if (model.handle_stiffness[vertex] > 0) refuse_second_handle(body, handle);
    model.handle_stiffness[vertex] = handle.stiffness;
    for (Part& part : model.parts) part.floats &= vertex < part.first_free || vertex >= part.first_free + part.free;
  }
}

}  // namespace

namespace {

std::size_t pairs_of(const ElementRecord& element) {
  return static_cast<std::size_t>(corners_of(element.kind)) * static_cast<std::size_t>(corners_of(element.kind));
}

// Adds weight G^T G, corner by corner, to the values at their places; place: null where the values are those of the
// element alone.
void add_term(const SystemTerm& term, int corners, const std::int32_t* place, double* values) {
  for (int a = 0; a < corners; ++a) {
    for (int b = 0; b < corners; ++b) {
      double product = 0;
      for (int i = 0; i < 3; ++i) product += term.row[a][i] * term.row[b][i];
      values[place != nullptr ? place[a * corners + b] : a * corners + b] += term.weight * product;
    }
  }
}

// Returns the part of A's diagonal that inertia and the springs of handles add to L [N/m].
double diagonal_part(const Model& model, std::int32_t v) {
  const double held = model.handle_stiffness.empty()
                          ? 0
                          : model.scheme.energy * model.scheme.theta * model.scheme.theta * model.handle_stiffness[v];
  return model.scheme.inertia * model.mass[v] / (model.time_step * model.time_step) + held;
}

}  // namespace

std::uint64_t new_structure() {
  static std::atomic<std::uint64_t> structures{0};
  return ++structures;
}

std::uint64_t new_values() {
  static std::atomic<std::uint64_t> values{0};
  return ++values;
}

ModelValues::ModelValues(const Model& model, const BodyDescription& body) : elements_(records_of(body)) {
  sort_elements(model, elements_);
  if (body.fabric.bending > 0) unit_bending_ = bending_matrix(model, body);
  if (body.fabric.bending > 0 && body.curved) unit_curvature_ = rest_curvature(model, body);
  elastic_ = pattern_of(model, elements_, unit_bending_);
  place_.reserve(elements_.size() * 16);
  for (const ElementRecord& element : elements_) {
    share_.resize(place_.size() + pairs_of(element));
    add_term(unit_term(element), corners_of(element.kind), nullptr, &share_[place_.size()]);
    for (int a = 0; a < corners_of(element.kind); ++a) {
      const int column = element.corner[a];
      const int* begin = elastic_.innerIndexPtr() + elastic_.outerIndexPtr()[column];
      const int* end = elastic_.innerIndexPtr() + elastic_.outerIndexPtr()[column + 1];
      for (int b = 0; b < corners_of(element.kind); ++b)
        place_.push_back(
            static_cast<std::int32_t>(std::lower_bound(begin, end, element.corner[b]) - elastic_.innerIndexPtr()));
    }
  }
}

// Sums up L = sum_e V_e k_e G_e^T G_e (equation 8 of the paper with its k), with fibres, bending and seams.
void ModelValues::add_up_elastic(Model& model) {
  double* values = elastic_.valuePtr();
  std::fill(values, values + elastic_.nonZeros(), 0.0);
  std::size_t at = 0;
  for (const ElementRecord& element : elements_) {
    const bool solid = element.kind == ElementKind::tetrahedron;
    const std::size_t first = at;
    if (element.kind == ElementKind::triangle) {
      add_term(model.system_term(element), corners_of(element.kind), &place_[first], values);
      at += pairs_of(element);
      continue;
    }
    const double k = solid ? model.stiffness[element.region].k : element.field[1];
    for (const std::size_t end = at + pairs_of(element); at < end; ++at) values[place_[at]] += k * share_[at];
    if (solid && !model.fibres.empty()) {
      const Fibre& fibre = model.fibres[element.region];
      if (fibre.kappa > 0) add_term(fibre_term(element, fibre), corners_of(element.kind), &place_[first], values);
    }
  }
  add_bending(model);
  add_seams(model);
}

// Adds Q to L, whose pattern has that of Q in it, and sets the rows by which the objective evaluates it.
void ModelValues::add_bending(Model& model) {
  model.bending = {};
  model.curvature = {};
  if (unit_bending_.nonZeros() == 0) return;
  const double stiffness = model.fabrics.front().bending;
  double* values = elastic_.valuePtr();
  model.bending.begin.push_back(0);
  for (int column = 0; column < unit_bending_.outerSize(); ++column) {
    const int* rows = elastic_.innerIndexPtr() + elastic_.outerIndexPtr()[column];
    for (Eigen::SparseMatrix<double>::InnerIterator entry(unit_bending_, column); entry; ++entry) {
      while (*rows != entry.row()) ++rows;
      values[rows - elastic_.innerIndexPtr()] += stiffness * entry.value();
      if (entry.row() == column) continue;
      model.bending.column.push_back(static_cast<std::int32_t>(entry.row()));
      model.bending.value.push_back(stiffness * entry.value());
    }
    model.bending.begin.push_back(static_cast<std::int32_t>(model.bending.column.size()));
  }
  if (unit_curvature_.empty() || stiffness <= 0) return;
  model.curvature = unit_curvature_;
  for (RestCurvature::Term& term : model.curvature.terms) term.factor *= std::sqrt(stiffness);
  for (RestCurvature::Turn& turn : model.curvature.turns) {
    for (double& place : turn.place) place *= std::sqrt(stiffness);
  }
  model.curvature.index(model.vertices);
}

// Chooses the stiffness of seams by that of the cloth where they are, and adds them to L. At this multiple, a seam in
// which the cloth is stretched by a tenth gapes by less than a hundredth of an edge.
void ModelValues::add_seams(Model& model) {
  constexpr double over_cloth = 10;
  const Eigen::VectorXd cloth = elastic_.diagonal();
  for (SeamPair& pair : model.seams.pairs) {
    pair.stiffness = 0;
    for (std::size_t i = 0; i < 3; ++i)
      pair.stiffness += 0.5 * over_cloth * std::abs(pair.factor[i]) * cloth[pair.vertex[i]];
  }
  for (const SeamPair& pair : model.seams.pairs)
    pair.for_each_entry(
        [&](std::int32_t row, std::int32_t column, double value) { elastic_.coeffRef(row, column) += value; });
}

namespace {

// Returns an element's part of Model::strain_stiffness [J].
double strain_stiffness(const Model& model, const ElementRecord& element) {
  if (element.kind == ElementKind::spring) return element.field[1] * element.field[0] * element.field[0];
  if (element.kind == ElementKind::triangle) {
    const auto& [warp, weft] = model.fabric_stiffness[element.region].along;
    return std::max(warp, weft) * element.field[4];
  }
  const double fibre = model.fibres.empty() ? 0 : model.fibres[element.region].kappa;
  return (model.stiffness[element.region].k + fibre) * element.field[9];
}

}  // namespace

// Returns the lower triangle of A over the free vertices. Entries that couple these to held vertices go to
// model.couplings, and the rows that damping needs go to model.damping.
Eigen::SparseMatrix<double> ModelValues::system_matrix(Model& model, double damping) const {
  const double h = model.time_step, drag = damping / h;
  const double stiffness = model.scheme.energy * model.scheme.theta * model.scheme.theta + drag;
  model.mean_stiffness = elastic_.diagonal().sum() / static_cast<double>(elements_.size());
  model.couplings.clear();
  model.damping = {};
  model.parts.front().drag = drag;
  if (damping > 0) model.damping.begin.push_back(0);
  Eigen::SparseMatrix<double> matrix(model.free, model.free);
  matrix.reserve(elastic_.nonZeros() / 2 + model.free);
  for (int column = 0; column < model.vertices; ++column) {
    if (column < model.free) matrix.startVec(column);
    for (Eigen::SparseMatrix<double>::InnerIterator entry(elastic_, column); entry; ++entry) {
      const auto row = static_cast<std::int32_t>(entry.row());
      const double own = row == column && row < model.free ? diagonal_part(model, row) : 0;
      if (column < model.free && row >= column && row < model.free)
        matrix.insertBack(row, column) = own + stiffness * entry.value();
      if (column < model.free && row >= model.free)
        model.couplings.push_back({column, row, stiffness * entry.value()});  // L is symmetric
      if (damping > 0) {
        model.damping.column.push_back(row);
        model.damping.value.push_back(drag * entry.value());
      }
    }
    if (damping > 0) model.damping.begin.push_back(static_cast<std::int32_t>(model.damping.column.size()));
  }
  matrix.finalize();
  return matrix;
}

void ModelValues::set(Model& model, const BodyDescription& body) {
  model.id = new_values();
  model.time_step = body.time_step;
  model.integrator = body.integrator;
  model.scheme = scheme_of(body.integrator);
  model.materials = body.materials;
  model.fibres.clear();
  if (std::any_of(body.fibres.begin(), body.fibres.end(), [](const Fibre& f) { return f.kappa > 0; })) {
    SUPPLE_CHECK(body.fibres.size(), ==, body.materials.size());
    model.fibres = body.fibres;
  }
  model.stiffness.clear();
  model.energy_may_be_negative = model.has_slack = false;
  for (const Material& material : model.materials) {
    model.stiffness.push_back(system_stiffness(material, body.fit));
    model.energy_may_be_negative |= energy_may_be_negative(material);
    model.has_slack |= has_slack(material);
  }
  model.fabrics.clear();
  model.fabric_stiffness.clear();
  if (!body.cloth.empty()) {
    model.fabrics.push_back(body.fabric);
    model.fabric_stiffness.push_back(system_stiffness(body.fabric.membrane, body.fit.start, body.fit.end));
  }
  const std::size_t arms = body.creep ? std::size_t(body.mesh.tets.rows()) : 0;
  SUPPLE_CHECK(elements_.size(), ==, elements_of(body) + arms);
  for (ElementRecord& element : elements_) {
    if (element.kind == ElementKind::spring) element.field[1] = body.springs[element.input].stiffness;
  }
  set_spring_fields(model, body.springs);
  model.plastic = body.plastic;
  model.creep = body.creep;
  set_arm_shares(model, body.mesh);
  model.single_field.assign(model.field.begin(), model.field.end());
  if (model.flows()) {
    model.present_field = model.field;
    model.present_single_field = model.single_field;
  }
  set_masses(model, body);
  set_handle_springs(model, body);
  add_up_elastic(model);
  model.strain_stiffness = 0;
  for (const ElementRecord& element : elements_) model.strain_stiffness += strain_stiffness(model, element);
  try {
    model.matrix = system_matrix(model, body.damping);
    const Eigen::VectorXd diagonal = model.matrix.diagonal();
    model.diagonal.assign(diagonal.begin(), diagonal.end());
    model.factor.factorize(model.matrix, body.precision);
  } catch (const RunError& error) {
    throw RunError(fmt::format("body '{}': {}", body.name, error.what()));
  }
}

}  // namespace supple
