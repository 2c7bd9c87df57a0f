// Sorts the free vertices of a model into colours such that no element joins two vertices of one colour, and packs the
// elements around the vertices of each colour for SIMD loops.
#pragma once

#include <vector>

#include "sim/model/model.h"

namespace supple {

// Holds elements of one kind and region that have a corner of the colour, in the layout of ElementChunk. This corner is
// renumbered as the element's corner 1.
struct CornerChunk {
  ElementKind kind;
  int region;
  int first_lane, blocks;  // first_lane: among all lanes of the colour
  std::vector<std::int32_t> vertex = {};
  std::vector<std::uint16_t> corner = {};
  AlignedVector<double> field = {};

  ElementChunk view(const Model& model) const;
};

struct VertexColor {
  std::vector<std::int32_t> vertices;
  std::vector<std::int32_t> lane_begin, lane;  // the elements of vertices[i]: lane[lane_begin[i] .. lane_begin[i+1])
  std::vector<CornerChunk> chunks;
  int lanes = 0;
};

std::vector<VertexColor> vertex_colors(const Model& model);

}  // namespace supple
