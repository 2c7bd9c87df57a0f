#include "sim/model/model.h"

#include <algorithm>
#include <array>

#include "base/error.h"
#include "sim/elements/element_kernels.h"
#include "sim/model/bending.h"
#include "sim/model/model_values.h"

namespace supple {
namespace {

constexpr int blocks_a_chunk =
    16;  // 256 elements and about 130 vertices: positions and forces fit the first-level cache

void number_vertices(Model& model, const BodyDescription& body, const std::vector<char>& held) {
  std::vector<std::int32_t> compact(model.vertices, -1), free_input;
  for (std::int32_t v = 0; v < model.vertices; ++v) {
    if (held[v]) continue;
    compact[v] = static_cast<std::int32_t>(free_input.size());
    free_input.push_back(v);
  }
  model.free = static_cast<int>(free_input.size());
  std::vector<std::pair<std::int32_t, std::int32_t>> edges;
  const auto join = [&](std::int32_t from, std::int32_t to) {
    if (compact[from] >= 0 && compact[to] >= 0) edges.emplace_back(compact[from], compact[to]);
  };
  for (Eigen::Index e = 0; e < body.mesh.tets.rows(); ++e) {
    for (int a = 0; a < 4; ++a) {
      for (int b = a + 1; b < 4; ++b) join(body.mesh.tets(e, a), body.mesh.tets(e, b));
    }
  }
  for (const Spring& spring : body.springs) join(spring.from, spring.to);
  for (const auto& [from, to] : joined_by_cloth(body)) join(from, to);
  for (const SeamPair& pair : body.seams) {
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < i; ++j) join(pair.vertex[i], pair.vertex[j]);
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
  for (std::int32_t i = 0; i < model.vertices && !body.overhang.empty(); ++i)
    model.overhang.push_back(body.overhang[std::size_t(model.input_of[i])]);
}

// Gives the model its seams, without their stiffness.
void number_seams(Model& model, const BodyDescription& body) {
  if (body.seams.empty()) return;
  model.seams.pairs = body.seams;
  for (SeamPair& pair : model.seams.pairs) {
    for (std::int32_t& v : pair.vertex) v = model.internal_of[v];
  }
  model.seams.index(model.vertices);
}

// Gives the model the places that touch colliders in the stead of its vertices.
void number_drawn(Model& model, const BodyDescription& body) {
  std::vector<std::int32_t> moved;  // by the numbers of the input
  for (std::int32_t v = 0; v < body.drawn_offset.rows(); ++v)
    if (!body.drawn_offset.row(v).isZero(0)) moved.push_back(v);
  model.drawn.frames = vertex_frames(body.mesh, moved);
  model.drawn.offset.resize(std::ssize(moved), 3);
  for (Eigen::Index i = 0; i < model.drawn.offset.rows(); ++i)
    model.drawn.offset.row(i) = body.drawn_offset.row(moved[std::size_t(i)]);
  for (std::int32_t& v : model.drawn.frames.vertex) v = model.internal_of[v];
  for (std::int32_t& v : model.drawn.frames.corner) v = model.internal_of[v];
}

// Sorts the triangles, so that neighbours stay together as their vertices do.
void number_surface(Model& model, const Triangles& input) {
  std::vector<std::array<std::int32_t, 3>> triangles;
  for (Eigen::Index t = 0; t < input.rows(); ++t)
    triangles.push_back(
        {model.internal_of[input(t, 0)], model.internal_of[input(t, 1)], model.internal_of[input(t, 2)]});
  std::stable_sort(triangles.begin(), triangles.end(), [](const auto& a, const auto& b) {
    return *std::min_element(a.begin(), a.end()) < *std::min_element(b.begin(), b.end());
  });
  model.surface.resize(std::ssize(triangles), 3);
  for (std::size_t t = 0; t < triangles.size(); ++t)
    model.surface.row(t) << triangles[t][0], triangles[t][1], triangles[t][2];
}

// Lists the vertices of some elements, each once.
std::vector<std::int32_t> vertices_of(const ElementRecord* begin, const ElementRecord* end) {
  std::vector<std::int32_t> list;
  for (const ElementRecord* e = begin; e != end; ++e)
    list.insert(list.end(), e->corner.begin(), e->corner.begin() + corners_of(e->kind));
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
  return list;
}

// Packs elements of one kind and region into one chunk. Padding repeats the first element with a weight of 0, so that
// its numbers are finite and add nothing. local: scratch by vertex.
void pack_chunk(Model& model, const ElementRecord* begin, const ElementRecord* end, std::vector<std::int32_t>& local) {
  const int corners = corners_of(begin->kind), fields = fields_of(begin->kind);
  const auto count = static_cast<int>(end - begin);
  const std::vector<std::int32_t> list = vertices_of(begin, end);
  const int blocks = (count + block_width - 1) / block_width;
  const Model::ChunkRange chunk{
      begin->kind,      begin->region,       model.blocks,       blocks,       int(model.chunk_vertex.size()),
      int(list.size()), model.corner.size(), model.field.size(), begin->is_arm};
  for (int i = 0; i < chunk.vertices; ++i) local[list[i]] = i;
  model.chunk_vertex.insert(model.chunk_vertex.end(), list.begin(), list.end());
  model.largest_chunk = std::max(model.largest_chunk, chunk.vertices);
  model.blocks += blocks;
  model.corner.resize(chunk.first_corner + std::size_t(blocks) * corners * block_width);
  model.field.resize(chunk.first_field + std::size_t(blocks) * fields * block_width);
  for (int place = 0; place < blocks * block_width; ++place) {
    const std::size_t block = place / block_width, lane = place % block_width;
    // Neighbours come into different blocks, so that the lanes of a block add forces to different vertices.
    const int record = static_cast<int>(lane) * blocks + static_cast<int>(block);
    const bool padding = record >= count;
    const ElementRecord& element = begin[padding ? 0 : record];
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
           elements[end].region == elements[begin].region && elements[end].is_arm == elements[begin].is_arm &&
           end - begin < blocks_a_chunk * block_width)
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

}  // namespace

ElementChunk Model::chunk(int index) const {
  const ChunkRange& c = chunks[index];
  const bool solid = c.kind == ElementKind::tetrahedron;
  return {c.kind,
          solid ? &materials[c.region] : nullptr,
          solid && !fibres.empty() && fibres[c.region].kappa > 0 ? &fibres[c.region] : nullptr,
          c.kind == ElementKind::triangle ? &fabrics[c.region].membrane : nullptr,
          c.blocks,
          c.vertices,
          chunk_vertex.data() + c.first_vertex,
          corner.data() + c.first_corner,
          (present_field.empty() ? field : present_field).data() + c.first_field,
          (present_field.empty() ? single_field : present_single_field).data() + c.first_field};
}

SystemTerm Model::system_term(const ElementRecord& element) const {
  if (element.kind == ElementKind::triangle) return membrane_term(element, fabric_stiffness[element.region]);
  SystemTerm term = unit_term(element);
  term.weight *= element.kind == ElementKind::tetrahedron ? stiffness[element.region].k : element.field[1];
  return term;
}

std::size_t Model::part_number(std::int32_t vertex) const {
  if (parts.size() == 1) return 0;
  const bool is_free = vertex < free;
  const auto begins_after = [is_free](std::int32_t v, const Part& part) {
    return v < (is_free ? part.first_free : part.first_held);
  };
  const auto after = std::upper_bound(parts.begin(), parts.end(), vertex, begins_after);
  return static_cast<std::size_t>(std::prev(after) - parts.begin());
}

void refuse_second_handle(const BodyDescription& body, const Handle& handle) {
  throw InputError(body.name, fmt::format("handle '{}' holds a vertex that another handle holds already", handle.name));
}

Model build_model(const BodyDescription& body) {
  Model model;
  model.structure = new_structure();
  model.name = body.name;
  model.vertices = static_cast<int>(body.mesh.rest.rows());
  for (const int region : body.mesh.regions) SUPPLE_CHECK(std::size_t(region), <, body.materials.size());
  for (const Spring& spring : body.springs) SUPPLE_CHECK(std::max(spring.from, spring.to), <, model.vertices);
  for (const FlatTriangle& triangle : body.cloth) {
    SUPPLE_CHECK(*std::ranges::max_element(triangle.corner), <, model.vertices);
    SUPPLE_CHECK(triangle.area(), >, 0);
  }

  std::vector<char> held(model.vertices, 0), has_spring(model.vertices, 0);
  for (const Handle& handle : body.handles) {
    const bool hard = handle.stiffness <= 0;
    for (const std::int32_t v : handle.vertices) {
      if (held[v] || (hard && has_spring[v])) refuse_second_handle(body, handle);
      (hard ? held : has_spring)[v] = 1;
    }
  }
  if (std::count(held.begin(), held.end(), 0) == 0)
    throw InputError(body.name, "every vertex is held: nothing is left to move");
  number_vertices(model, body, held);
  number_seams(model, body);
  number_drawn(model, body);
  const double size = bounds_of(body.mesh.rest).diagonal();
  model.parts = {Part{.name = body.name,
                      .free = model.free,
                      .first_held = model.free,
                      .held = model.vertices - model.free,
                      .size = size,
                      .solid = body.mesh.tets.rows() > 0}};
  model.size = size;
  number_surface(model, body.surface.rows() > 0 ? body.surface : boundary_faces(body.mesh.tets));
  model.parts.front().triangles = static_cast<std::int32_t>(model.surface.rows());
  for (std::size_t h = 0; h < body.handles.size(); ++h) {
    for (const std::int32_t v : body.handles[h].vertices)
      model.handled.push_back({model.internal_of[v], static_cast<std::int32_t>(h)});
  }
  ModelValues values(model, body);
  pack_elements(model, values.elements());
  values.set(model, body);
  return model;
}

}  // namespace supple
