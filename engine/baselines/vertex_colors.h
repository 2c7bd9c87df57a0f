// Sorts the free vertices of a model into colours such that no element joins two vertices of one colour, and packs the
// elements around the vertices of each colour for SIMD loops.
#pragma once

#include <vector>

#include "sim/model/model.h"

namespace supple {

// Holds elements of one kind and region, in the layout of ElementChunk. An element is there once for each of its
// corners that has the colour, which is then its corner 1.
struct CornerChunk {
  ElementKind kind;
  int region;
  int first_lane, blocks;  // among all lanes of the colour
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
