#include "sim/model.h"

#include <algorithm>
#include <atomic>
#include <numeric>

#include "base/error.h"

namespace supple {
namespace {

constexpr int blocks_a_chunk =
    32;  // 256 elements and about 130 vertices: positions and forces fit the first-level cache

void number_vertices(Model& model, const BodyDescription& body, const std::vector<ElementRecord>& elements,
                     const std::vector<char>& held) {
  std::vector<std::int32_t> compact(model.vertices, -1), free_input;
  for (std::int32_t v = 0; v < model.vertices; ++v) {
    if (held[v]) continue;
    compact[v] = static_cast<std::int32_t>(free_input.size());
    free_input.push_back(v);
  }
  model.free = static_cast<int>(free_input.size());
  std::vector<std::pair<std::int32_t, std::int32_t>> edges;
  for (const ElementRecord& element : elements) {
    for (int a = 0; a < corners_of(element.kind); ++a) {
      for (int b = a + 1; b < corners_of(element.kind); ++b) {
        const std::int32_t i = compact[element.corner[a]], j = compact[element.corner[b]];
        if (i >= 0 && j >= 0) edges.emplace_back(i, j);
      }
    }
  }
  for (const std::int32_t i : fill_reducing_order(model.free, edges)) model.input_of.push_back(free_input[i]);
  for (std::int32_t v = 0; v < model.vertices; ++v) {
    if (held[v]) model.input_of.push_back(v);
  }
  model.internal_of.resize(model.vertices);
  for (std::int32_t i = 0; i < model.vertices; ++i) model.internal_of[model.input_of[i]] = i;
  model.rest.resize(model.vertices, 3);
  for (std::int32_t i = 0; i < model.vertices; ++i) model.rest.row(i) = body.mesh.rest.row(model.input_of[i]);
}

// Corners in the model's numbering, in the order in which they are packed: by kind and region, then by first vertex.
void sort_elements(const Model& model, std::vector<ElementRecord>& elements) {
  for (ElementRecord& element : elements) {
    for (int k = 0; k < corners_of(element.kind); ++k) element.corner[k] = model.internal_of[element.corner[k]];
  }
  const auto key = [](const ElementRecord& e) {
    const auto end = e.corner.begin() + corners_of(e.kind);
    return std::tuple(e.kind, e.region, *std::min_element(e.corner.begin(), end), e.input);
  };
  std::sort(elements.begin(), elements.end(),
            [&](const ElementRecord& a, const ElementRecord& b) { return key(a) < key(b); });
}

// The vertices of some elements, each once.
std::vector<std::int32_t> vertices_of(const ElementRecord* begin, const ElementRecord* end) {
  std::vector<std::int32_t> list;
  for (const ElementRecord* e = begin; e != end; ++e)
    list.insert(list.end(), e->corner.begin(), e->corner.begin() + corners_of(e->kind));
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
  return list;
}

// Packs elements of one kind and region into one chunk. Padding repeats the first element without its weight: finite,
// and worth nothing. local: scratch by vertex.
void pack_chunk(Model& model, const ElementRecord* begin, const ElementRecord* end, std::vector<std::int32_t>& local) {
  const int corners = corners_of(begin->kind), fields = fields_of(begin->kind);
  const auto count = static_cast<int>(end - begin);
  const std::vector<std::int32_t> list = vertices_of(begin, end);
  const int blocks = (count + block_width - 1) / block_width;
  const Model::ChunkRange chunk{
      begin->kind,      begin->region,       model.blocks,      blocks, int(model.chunk_vertex.size()),
      int(list.size()), model.corner.size(), model.field.size()};
  for (int i = 0; i < chunk.vertices; ++i) local[list[i]] = i;
  model.chunk_vertex.insert(model.chunk_vertex.end(), list.begin(), list.end());
  model.largest_chunk = std::max(model.largest_chunk, chunk.vertices);
  model.blocks += blocks;
  model.corner.resize(chunk.first_corner + std::size_t(blocks) * corners * block_width);
  model.field.resize(chunk.first_field + std::size_t(blocks) * fields * block_width);
  for (int place = 0; place < blocks * block_width; ++place) {
    const bool padding = place >= count;
    const ElementRecord& element = begin[padding ? 0 : place];
    const std::size_t block = place / block_width, lane = place % block_width;
    for (int k = 0; k < corners; ++k) {
      model.corner[chunk.first_corner + (block * corners + k) * block_width + lane] =
          static_cast<std::uint16_t>(local[element.corner[k]]);
    }
    for (int i = 0; i < fields; ++i) {
      model.field[chunk.first_field + (block * fields + i) * block_width + lane] =
          padding && i == fields - 1 ? 0 : element.field[i];
    }
    model.element_of_lane.push_back(padding ? -1 : element.input);
  }
  model.chunks.push_back(chunk);
}

void pack_elements(Model& model, const std::vector<ElementRecord>& elements) {
  model.elements = static_cast<int>(elements.size());
  std::vector<std::int32_t> local(model.vertices, -1);
  for (std::size_t begin = 0; begin < elements.size();) {
    std::size_t end = begin;
    while (end < elements.size() && elements[end].kind == elements[begin].kind &&
           elements[end].region == elements[begin].region && end - begin < blocks_a_chunk * block_width)
      ++end;
    pack_chunk(model, &elements[begin], elements.data() + end, local);
    begin = end;
  }
  std::vector<std::vector<std::int32_t>> slots(model.free);
  for (std::size_t slot = 0; slot < model.chunk_vertex.size(); ++slot) {
    if (model.chunk_vertex[slot] < model.free)
      slots[model.chunk_vertex[slot]].push_back(static_cast<std::int32_t>(slot));
  }
  model.slot_begin.push_back(0);
  for (const auto& list : slots) {
    model.slots.insert(model.slots.end(), list.begin(), list.end());
    model.slot_begin.push_back(static_cast<std::int32_t>(model.slots.size()));
  }
}

// L = sum_e V_e k_e G_e^T G_e (equation 8 of the paper with its k), over all vertices.
Eigen::SparseMatrix<double> elastic_matrix(const Model& model, const std::vector<ElementRecord>& elements) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(elements.size() * 16);
  for (const ElementRecord& element : elements) {
    const bool solid = element.kind == ElementKind::tetrahedron;
    const Fibre* fibre = solid && !model.fibres.empty() ? &model.fibres[element.region] : nullptr;
    const double k = solid ? model.stiffness[element.region].k : 0;
    for (const SystemTerm& term : system_terms(element, k, fibre)) {
      for (int a = 0; a < corners_of(element.kind); ++a) {
        for (int b = 0; b < corners_of(element.kind); ++b) {
          double product = 0;
          for (int i = 0; i < 3; ++i) product += term.row[a][i] * term.row[b][i];
          entries.emplace_back(element.corner[a], element.corner[b], term.weight * product);
        }
      }
    }
  }
  Eigen::SparseMatrix<double> matrix(model.vertices, model.vertices);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

// A over the free vertices, its lower triangle; what couples them to held vertices goes to model.couplings, and what
// damping needs to model.damping.
Eigen::SparseMatrix<double> system_matrix(Model& model, const std::vector<ElementRecord>& elements, double damping) {
  const double h = model.time_step, drag = damping / h;
  const double stiffness = model.scheme.energy * model.scheme.theta * model.scheme.theta + drag;
  const Eigen::SparseMatrix<double> elastic = elastic_matrix(model, elements);
  model.mean_stiffness = elastic.diagonal().sum() / static_cast<double>(elements.size());
  std::vector<Eigen::Triplet<double>> entries;
  for (int v = 0; v < model.free; ++v) {
    entries.emplace_back(
        v, v,
        model.scheme.inertia * model.mass[v] / (h * h) +
            (model.spring.empty() ? 0.0
                                  : model.scheme.energy * model.scheme.theta * model.scheme.theta * model.spring[v]));
  }
  if (damping > 0) model.damping.begin.push_back(0);
  for (int column = 0; column < model.vertices; ++column) {
    for (Eigen::SparseMatrix<double>::InnerIterator entry(elastic, column); entry; ++entry) {
      const auto row = static_cast<std::int32_t>(entry.row());
      if (row >= column && row < model.free) entries.emplace_back(row, column, stiffness * entry.value());
      if (column < model.free && row >= model.free)
        model.couplings.push_back({column, row, stiffness * entry.value()});  // L is symmetric
      if (damping > 0) {
        model.damping.column.push_back(row);
        model.damping.value.push_back(drag * entry.value());
      }
    }
    if (damping > 0) model.damping.begin.push_back(static_cast<std::int32_t>(model.damping.column.size()));
  }
  Eigen::SparseMatrix<double> matrix(model.free, model.free);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

void place_handles(Model& model, const BodyDescription& body) {
  for (std::size_t h = 0; h < body.handles.size(); ++h) {
    const Handle& handle = body.handles[h];
    for (const std::int32_t v : handle.vertices) {
      model.handled.push_back({model.internal_of[v], static_cast<std::int32_t>(h)});
      if (handle.spring <= 0) continue;
      if (model.spring.empty()) model.spring.assign(model.free, 0.0);
      model.spring[model.internal_of[v]] = handle.spring;
    }
  }
  model.free_floating = model.handled.empty();
}

}  // namespace

ElementChunk Model::chunk(int index) const {
  const ChunkRange& c = chunks[index];
  const bool solid = c.kind == ElementKind::tetrahedron;
  return {c.kind,
          solid ? &materials[c.region] : nullptr,
          solid && !fibres.empty() && fibres[c.region].kappa > 0 ? &fibres[c.region] : nullptr,
          c.blocks,
          c.vertices,
          chunk_vertex.data() + c.first_vertex,
          corner.data() + c.first_corner,
          field.data() + c.first_field};
}

Model build_model(const BodyDescription& body) {
  static std::atomic<std::uint64_t> builds{0};
  Model model;
  model.id = ++builds;
  model.name = body.name;
  model.vertices = static_cast<int>(body.mesh.rest.rows());
  model.time_step = body.time_step;
  model.size = bounds_of(body.mesh.rest).diagonal();
  model.integrator = body.integrator;
  model.scheme = scheme_of(body.integrator);
  model.materials = body.materials;
  if (std::any_of(body.fibres.begin(), body.fibres.end(), [](const Fibre& f) { return f.kappa > 0; }))
    model.fibres = body.fibres;
  for (const int region : body.mesh.regions) SUPPLE_CHECK(std::size_t(region), <, body.materials.size());
  if (!body.point_mass.empty()) SUPPLE_CHECK(body.point_mass.size(), ==, std::size_t(model.vertices));
  for (const Spring& spring : body.springs) SUPPLE_CHECK(std::max(spring.from, spring.to), <, model.vertices);
  if (!model.fibres.empty()) SUPPLE_CHECK(model.fibres.size(), ==, body.materials.size());
  for (const Material& material : model.materials) {
    model.stiffness.push_back(system_stiffness(material, body.fit));
    model.energy_may_be_negative |= may_be_negative(material);
  }

  std::vector<char> held(model.vertices, 0), taken(model.vertices, 0);
  for (const Handle& handle : body.handles) {
    for (const std::int32_t v : handle.vertices) {
      if (taken[v])
        throw InputError(body.name,
                         fmt::format("handle '{}' holds a vertex that another handle holds already", handle.name));
      taken[v] = 1;
      held[v] = handle.spring <= 0;
    }
  }
  if (std::count(held.begin(), held.end(), 0) == 0)
    throw InputError(body.name, "every vertex is held: nothing is left to move");
  std::vector<ElementRecord> elements = element_records(body.mesh, body.springs);
  number_vertices(model, body, elements, held);
  model.mass.assign(model.vertices, 0.0);
  for (Eigen::Index e = 0; e < body.mesh.tets.rows(); ++e) {
    const double quarter = body.density * tet_volume(body.mesh, e) / 4;
    for (int k = 0; k < 4; ++k) model.mass[model.internal_of[body.mesh.tets(e, k)]] += quarter;
  }
  for (std::size_t v = 0; v < body.point_mass.size(); ++v) model.mass[model.internal_of[v]] += body.point_mass[v];
  model.total_mass = std::accumulate(model.mass.begin(), model.mass.begin() + model.free, 0.0);
  place_handles(model, body);
  sort_elements(model, elements);
  pack_elements(model, elements);
  try {
    const Eigen::SparseMatrix<double> system = system_matrix(model, elements, body.damping);
    const Eigen::VectorXd diagonal = system.diagonal();
    model.diagonal.assign(diagonal.begin(), diagonal.end());
    model.factor = CholeskyFactor(system, body.precision);
  } catch (const RunError& error) {
    throw RunError(fmt::format("body '{}': {}", body.name, error.what()));
  }
  return model;
}

}  // namespace supple
