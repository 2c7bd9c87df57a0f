#include "sim/model.h"

#include <Eigen/LU>
#include <algorithm>
#include <map>
#include <numeric>

#include "base/error.h"

namespace supple {
namespace {

constexpr int blocks_a_chunk =
    32;  // 256 elements and about 130 vertices: positions and forces fit the first-level cache

// The least k, as a share of the largest Lame-like parameter: a material that softens over the whole interval fits k <=
// 0, and A would not be positive definite.
constexpr double stiffness_floor = 1e-3;

double largest_parameter(const Material& material) {
  return std::visit(
      [](const auto& m) {
        double largest = 0;
        for (const auto& parameter : std::decay_t<decltype(m)>::parameters())
          largest = std::max(largest, m.*parameter.value);
        return largest;
      },
      material);
}

void fit_stiffness(Model& model, const StretchInterval& fit) {
  for (const Material& material : model.materials) {
    const double k = stiffness(material, fit);
    const double least = stiffness_floor * largest_parameter(material);
    model.stiffness.push_back(std::max(k, least));
    model.floored.push_back(k < least);
  }
}

// The constant gradients of the four shape functions, one row a corner [1/m].
Eigen::Matrix<double, 4, 3> shape_gradients(const Mat3& rest_inverse) {
  Eigen::Matrix<double, 4, 3> g;
  g.bottomRows<3>() = rest_inverse;
  g.row(0) = -rest_inverse.colwise().sum();
  return g;
}

struct Element {
  std::int32_t input;
  std::array<std::int32_t, 4> corner;  // internal vertices
  int material;
};

void number_vertices(Model& model, const BodyDescription& body, const std::vector<char>& held) {
  const Tetrahedra& tets = body.mesh.tets;
  std::vector<std::int32_t> compact(model.vertices, -1), free_input;
  for (std::int32_t v = 0; v < model.vertices; ++v) {
    if (held[v]) continue;
    compact[v] = static_cast<std::int32_t>(free_input.size());
    free_input.push_back(v);
  }
  model.free = static_cast<int>(free_input.size());
  std::vector<std::pair<std::int32_t, std::int32_t>> edges;
  for (Eigen::Index e = 0; e < tets.rows(); ++e) {
    for (int a = 0; a < 4; ++a) {
      for (int b = a + 1; b < 4; ++b) {
        const std::int32_t i = compact[tets(e, a)], j = compact[tets(e, b)];
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

std::vector<Element> sorted_elements(const Model& model, const TetMesh& mesh) {
  std::vector<Element> elements(mesh.tets.rows());
  for (Eigen::Index e = 0; e < mesh.tets.rows(); ++e) {
    Element& element = elements[e];
    element.input = static_cast<std::int32_t>(e);
    element.material = mesh.regions.empty() ? 0 : mesh.regions[e];
    for (int k = 0; k < 4; ++k) element.corner[k] = model.internal_of[mesh.tets(e, k)];
  }
  const auto key = [](const Element& e) {
    return std::tuple(e.material, *std::min_element(e.corner.begin(), e.corner.end()), e.input);
  };
  std::sort(elements.begin(), elements.end(), [&](const Element& a, const Element& b) { return key(a) < key(b); });
  return elements;
}

// Fills one lane. Padding repeats the chunk's first element without volume: finite, and worth nothing.
void fill_lane(Model& model, int block, int lane, const Element& element, bool padding,
               const std::vector<std::int32_t>& local) {
  Mat3 edges;
  for (int k = 0; k < 3; ++k)
    edges.col(k) = (model.rest.row(element.corner[k + 1]) - model.rest.row(element.corner[0])).transpose();
  const Mat3 inverse = edges.inverse();
  const auto at = [&](int field, int fields) { return (std::size_t(block) * fields + field) * block_width + lane; };
  for (int i = 0; i < 9; ++i) model.rest_inverse[at(i, 9)] = inverse(i / 3, i % 3);
  for (int k = 0; k < 4; ++k) model.corner[at(k, 4)] = static_cast<std::uint16_t>(local[element.corner[k]]);
  model.volume[at(0, 1)] = padding ? 0 : edges.determinant() / 6;
  model.element_of_lane[at(0, 1)] = padding ? -1 : element.input;
}

void pack_elements(Model& model, const std::vector<Element>& elements) {
  model.elements = static_cast<int>(elements.size());
  std::vector<std::int32_t> local(model.vertices, -1);
  for (std::size_t begin = 0; begin < elements.size();) {
    const int material = elements[begin].material;
    std::size_t end = begin;
    while (end < elements.size() && elements[end].material == material && end - begin < blocks_a_chunk * block_width)
      ++end;
    Model::ChunkRange chunk{model.blocks, int((end - begin + block_width - 1) / block_width),
                            int(model.chunk_vertex.size()), 0, material};
    std::vector<std::int32_t> list;
    for (std::size_t e = begin; e < end; ++e)
      list.insert(list.end(), elements[e].corner.begin(), elements[e].corner.end());
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    chunk.vertices = static_cast<int>(list.size());
    for (int i = 0; i < chunk.vertices; ++i) local[list[i]] = i;
    model.chunk_vertex.insert(model.chunk_vertex.end(), list.begin(), list.end());
    model.largest_chunk = std::max(model.largest_chunk, chunk.vertices);
    model.blocks += chunk.blocks;
    model.corner.resize(std::size_t(model.blocks) * 4 * block_width);
    model.rest_inverse.resize(std::size_t(model.blocks) * 9 * block_width);
    model.volume.resize(std::size_t(model.blocks) * block_width);
    model.element_of_lane.resize(std::size_t(model.blocks) * block_width);
    for (int lane = 0; lane < chunk.blocks * block_width; ++lane) {
      const bool padding = begin + lane >= end;
      fill_lane(model, chunk.first_block + lane / block_width, lane % block_width,
                elements[padding ? begin : begin + lane], padding, local);
    }
    model.chunks.push_back(chunk);
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

// A = M/h^2 + sum_e V_e k_e G_e^T G_e + springs, over the free vertices (equation 8 of the paper with its k); what
// couples them to held vertices goes to model.couplings.
Eigen::SparseMatrix<double> system_matrix(Model& model, const std::vector<Element>& elements) {
  std::vector<Eigen::Triplet<double>> entries;
  std::map<std::pair<std::int32_t, std::int32_t>, double> couplings;
  entries.reserve(elements.size() * 10 + model.free);
  const double h = model.time_step;
  for (int v = 0; v < model.free; ++v)
    entries.emplace_back(v, v, model.mass[v] / (h * h) + (model.spring.empty() ? 0.0 : model.spring[v]));
  for (const Element& element : elements) {
    Mat3 edges;
    for (int k = 0; k < 3; ++k)
      edges.col(k) = (model.rest.row(element.corner[k + 1]) - model.rest.row(element.corner[0])).transpose();
    const Eigen::Matrix<double, 4, 3> g = shape_gradients(edges.inverse());
    const double weight = edges.determinant() / 6 * model.stiffness[element.material];
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < 4; ++b) {
        const std::int32_t i = element.corner[a], j = element.corner[b];
        const double value = weight * g.row(a).dot(g.row(b));
        if (i >= j && i < model.free) entries.emplace_back(i, j, value);
        if (i < model.free && j >= model.free) couplings[{i, j}] += value;
      }
    }
  }
  for (const auto& [place, value] : couplings) model.couplings.push_back({place.first, place.second, value});
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
  return {&materials[c.material],
          c.blocks,
          c.vertices,
          chunk_vertex.data() + c.first_vertex,
          corner.data() + std::size_t(c.first_block) * 4 * block_width,
          rest_inverse.data() + std::size_t(c.first_block) * 9 * block_width,
          volume.data() + std::size_t(c.first_block) * block_width};
}

Model build_model(const BodyDescription& body) {
  Model model;
  model.name = body.name;
  model.vertices = static_cast<int>(body.mesh.rest.rows());
  model.time_step = body.time_step;
  model.size = bounds_of(body.mesh.rest).diagonal();
  model.materials = body.materials;
  for (const int region : body.mesh.regions) SUPPLE_CHECK(std::size_t(region), <, body.materials.size());

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
  fit_stiffness(model, body.fit);
  number_vertices(model, body, held);
  model.mass.assign(model.vertices, 0.0);
  for (Eigen::Index e = 0; e < body.mesh.tets.rows(); ++e) {
    const double quarter = body.density * tet_volume(body.mesh, e) / 4;
    for (int k = 0; k < 4; ++k) model.mass[model.internal_of[body.mesh.tets(e, k)]] += quarter;
  }
  model.total_mass = std::accumulate(model.mass.begin(), model.mass.begin() + model.free, 0.0);
  place_handles(model, body);
  const std::vector<Element> elements = sorted_elements(model, body.mesh);
  pack_elements(model, elements);
  try {
    model.factor = CholeskyFactor(system_matrix(model, elements), body.precision);
  } catch (const RunError& error) {
    throw RunError(fmt::format("body '{}': {}", body.name, error.what()));
  }
  return model;
}

}  // namespace supple
