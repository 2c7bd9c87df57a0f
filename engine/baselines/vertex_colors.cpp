#include "baselines/vertex_colors.h"

#include <algorithm>
#include <utility>

#include "sim/model/element_view.h"

namespace supple {
namespace {

constexpr int elements_a_chunk = 16 * block_width;

// Names a corner of an element.
struct ElementCorner {
  std::int32_t element;
  int corner;
};
using CornersByVertex = std::vector<std::vector<ElementCorner>>;

CornersByVertex corners_of_vertices(const Model& model, const std::vector<ElementView>& elements) {
  CornersByVertex at(model.free);
  for (std::size_t e = 0; e < elements.size(); ++e) {
    for (int k = 0; k < corners_of(elements[e].kind); ++k) {
      if (elements[e].corner[k] < model.free) at[elements[e].corner[k]].push_back({static_cast<std::int32_t>(e), k});
    }
  }
  return at;
}

// Gives each free vertex the lowest number that no neighbour with a lower index has.
std::vector<int> greedy_colors(const Model& model, const std::vector<ElementView>& elements,
                               const CornersByVertex& corners) {
  std::vector<int> color(corners.size(), -1);
  std::vector<std::size_t> seen;  // by colour: the last vertex with a neighbour that has it
  for (std::size_t v = 0; v < corners.size(); ++v) {
    for (const ElementCorner& at : corners[v]) {
      const ElementView& element = elements[at.element];
      for (int k = 0; k < corners_of(element.kind); ++k) {
        const auto other = static_cast<std::size_t>(element.corner[k]);
        if (other < v) seen[color[other]] = v;
      }
    }
    for (std::int32_t k = model.bending.begin.empty() ? 0 : model.bending.begin[v];
         !model.bending.begin.empty() && k < model.bending.begin[v + 1]; ++k) {
      const auto other = static_cast<std::size_t>(model.bending.column[k]);
      if (other < v) seen[color[other]] = v;
    }
    for (const Seams::Share& share : model.seams.of(v)) {
      for (const std::int32_t other : model.seams.pairs[std::size_t(share.pair)].vertex)
        if (std::size_t(other) < v) seen[color[std::size_t(other)]] = v;
    }
    const auto unseen = std::find_if(seen.begin(), seen.end(), [&](std::size_t last) { return last != v; });
    color[v] = static_cast<int>(unseen - seen.begin());
    if (unseen == seen.end()) seen.push_back(corners.size());
  }
  return color;
}

// Renumbers the corners of an element so that `corner` becomes its corner 1.
ElementView turned(ElementView element, int corner) {
  auto& field = element.field;
  if (element.kind != ElementKind::spring) {
    const int inner = corners_of(element.kind) - 1;  // gradients of corners 1 and on, with as many numbers each
    for (int c = 0; c < inner; ++c) {
      if (corner > 0) {
        std::swap(field[c], field[inner * (corner - 1) + c]);
        continue;
      }
      double sum = 0;  // the gradients of all corners add up to zero
      for (int k = 0; k < inner; ++k) sum += field[inner * k + c];
      field[c] = -sum;
    }
  }
  std::swap(element.corner[1], element.corner[corner]);
  return element;
}

// Packs elements of one kind and region. Padding repeats the first element without its weight.
CornerChunk packed(const ElementView* begin, const ElementView* end, int first_lane) {
  const int corners = corners_of(begin->kind), fields = fields_of(begin->kind);
  const auto count = static_cast<int>(end - begin);
  CornerChunk chunk{begin->kind, begin->region, first_lane, (count + block_width - 1) / block_width};
  for (const ElementView* e = begin; e != end; ++e)
    chunk.vertex.insert(chunk.vertex.end(), e->corner.begin(), e->corner.begin() + corners);
  std::sort(chunk.vertex.begin(), chunk.vertex.end());
  chunk.vertex.erase(std::unique(chunk.vertex.begin(), chunk.vertex.end()), chunk.vertex.end());
  chunk.corner.resize(std::size_t(chunk.blocks) * corners * block_width);
  chunk.field.resize(std::size_t(chunk.blocks) * fields * block_width);
  for (int place = 0; place < chunk.blocks * block_width; ++place) {
    const ElementView& element = begin[place < count ? place : 0];
    const std::size_t block = place / block_width, lane = place % block_width;
    for (int k = 0; k < corners; ++k) {
      const auto at = std::lower_bound(chunk.vertex.begin(), chunk.vertex.end(), element.corner[k]);
      chunk.corner[(block * corners + k) * block_width + lane] = static_cast<std::uint16_t>(at - chunk.vertex.begin());
    }
    for (int i = 0; i < fields; ++i)
      chunk.field[(block * fields + i) * block_width + lane] = place >= count && i == fields - 1 ? 0 : element.field[i];
  }
  return chunk;
}

void pack(const std::vector<ElementView>& elements, const CornersByVertex& corners, VertexColor& color) {
  struct Turned {
    ElementView element;
    std::size_t vertex;  // its place among those of the colour
  };
  std::vector<Turned> list;
  for (std::size_t i = 0; i < color.vertices.size(); ++i) {
    for (const ElementCorner& at : corners[color.vertices[i]])
      list.push_back({turned(elements[at.element], at.corner), i});
  }
  const auto group = [](const Turned& t) { return std::pair(t.element.kind, t.element.region); };
  std::stable_sort(list.begin(), list.end(), [&](const Turned& a, const Turned& b) { return group(a) < group(b); });
  std::vector<std::vector<std::int32_t>> lanes(color.vertices.size());
  std::vector<ElementView> run;
  for (std::size_t begin = 0; begin < list.size();) {
    run.clear();
    for (std::size_t i = begin;
         i < list.size() && group(list[i]) == group(list[begin]) && run.size() < elements_a_chunk; ++i) {
      lanes[list[i].vertex].push_back(color.lanes + static_cast<std::int32_t>(run.size()));
      run.push_back(list[i].element);
    }
    color.chunks.push_back(packed(run.data(), run.data() + run.size(), color.lanes));
    color.lanes += color.chunks.back().blocks * block_width;
    begin += run.size();
  }
  color.lane_begin.push_back(0);
  for (const auto& of_vertex : lanes) {
    color.lane.insert(color.lane.end(), of_vertex.begin(), of_vertex.end());
    color.lane_begin.push_back(static_cast<std::int32_t>(color.lane.size()));
  }
}

}  // namespace

ElementChunk CornerChunk::view(const Model& model) const {
  const bool solid = kind == ElementKind::tetrahedron;
  const bool fibred = solid && !model.fibres.empty() && model.fibres[region].kappa > 0;
  return {kind,
          solid ? &model.materials[region] : nullptr,
          fibred ? &model.fibres[region] : nullptr,
          kind == ElementKind::triangle ? &model.fabrics[region].membrane : nullptr,
          blocks,
          static_cast<int>(vertex.size()),
          vertex.data(),
          corner.data(),
          field.data(),
          nullptr};
}

std::vector<VertexColor> vertex_colors(const Model& model) {
  std::vector<ElementView> elements;
  for_each_element(model, [&](const ElementView& element) { elements.push_back(element); });
  const CornersByVertex corners = corners_of_vertices(model, elements);
  const std::vector<int> color_of = greedy_colors(model, elements, corners);
  std::vector<VertexColor> colors;
  for (int v = 0; v < model.free; ++v) {
    if (color_of[v] >= static_cast<int>(colors.size())) colors.resize(color_of[v] + 1);
    colors[color_of[v]].vertices.push_back(v);
  }
  for (VertexColor& color : colors) pack(elements, corners, color);
  return colors;
}

}  // namespace supple
