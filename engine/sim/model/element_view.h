// Visits a model's elements one by one, taken out of their SIMD blocks: for code whose speed does not matter.
#pragma once

#include "sim/elements/element.h"
#include "sim/elements/element_kernels.h"
#include "sim/elements/element_records.h"
#include "sim/model/model.h"

namespace supple {

// Describes one element, whose corners have the model's numbering.
struct ElementView : ElementRecord {
  int lane;  // number of its lane among those of all blocks
};

// Calls visit(ElementView) for each element of a chunk in the order of lanes; padding is left out.
template <class Visit>
void for_each_element(const Model& model, const Model::ChunkRange& range, const Visit& visit) {
  const std::int32_t* list = model.chunk_vertex.data() + range.first_vertex;
  const int corners = corners_of(range.kind), fields = fields_of(range.kind);
  for (int place = 0; place < range.blocks * block_width; ++place) {
    const int at = range.first_block * block_width + place;
    if (model.element_of_lane[at] < 0) continue;
    ElementView element{{range.kind, range.region, model.element_of_lane[at], {}, {}, range.is_arm}, at};
    const std::size_t block = place / block_width, lane = place % block_width;
    for (int k = 0; k < corners; ++k)
      element.corner[k] = list[model.corner[range.first_corner + (block * corners + k) * block_width + lane]];
    for (int i = 0; i < fields; ++i)
      element.field[i] = model.field[range.first_field + (block * fields + i) * block_width + lane];
    visit(element);
  }
}

// Returns an element as the kernels see it: with the rest shape that flow has left (model/flow.h).
inline ElementView as_flowed(const Model& model, const Model::ChunkRange& range, ElementView element) {
  if (model.present_field.empty()) return element;
  const std::size_t place = std::size_t(element.lane) - std::size_t(range.first_block) * block_width;
  const std::size_t fields = fields_of(range.kind), block = place / block_width, lane = place % block_width;
  for (std::size_t i = 0; i < fields; ++i)
    element.field[i] = model.present_field[range.first_field + (block * fields + i) * block_width + lane];
  return element;
}

// Visits the elements of all chunks, one chunk after the other.
template <class Visit>
void for_each_element(const Model& model, const Visit& visit) {
  for (const Model::ChunkRange& range : model.chunks) for_each_element(model, range, visit);
}

// Returns the tetrahedra of a model, each once, by its vertices.
Tetrahedra tetrahedra_of(const Model& model);

// Returns F of a tetrahedron.
inline Mat3 deformation_gradient(const Positions& x, const ElementView& element) {
  Mat3 edges, inverse;
  for (int k = 0; k < 3; ++k) edges.col(k) = (x.row(element.corner[k + 1]) - x.row(element.corner[0])).transpose();
  for (int i = 0; i < 9; ++i) inverse(i / 3, i % 3) = element.field[i];
  return edges * inverse;
}

}  // namespace supple
