// Lists the places of a skin, and tells which of them an edge joins, so that what belongs together can be told from
// what is merely near.
#pragma once

#include <vector>

#include "geometry/meshes/mesh.h"

namespace supple {

struct SkinEdge {
  std::int32_t to;
  double length;  // [m]
};

// Holds the places as nodes. Skin vertices at exactly the same place, as along a crease, are one node.
struct SkinGraph {
  std::vector<std::int32_t> node_of;         // by skin vertex
  std::vector<std::int32_t> vertex_of;       // by node: one of its skin vertices
  Positions place;                           // by node [m]
  Positions normal;                          // by node; of unit length, or 0 where no triangle has an area
  std::vector<std::vector<SkinEdge>> edges;  // by node
};

SkinGraph skin_graph(const TriMesh& skin);

}  // namespace supple
