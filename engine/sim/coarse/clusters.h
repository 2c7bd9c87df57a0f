// Divides a body into overlapping clusters of vertices, whose rigid motions are the second level of search directions
// (coarse_system.h). Centres are spread by distance along the body, so that a bar has them along it, and an ear that
// touches a head is no part of it. The weights are those of an embedded deformation graph (Sumner, Schmid, Pauly 2007,
// "Embedded deformation for shape manipulation", section 3): a vertex belongs to the nearest few centres, by (1 - d /
// d_most)^2 at the distance d, where d_most is that of the first centre to which it does not belong.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sim/model/model.h"

namespace supple {

struct Clusters {
  static constexpr int most_of_vertex = 3;

  std::vector<std::int32_t> center;  // by cluster: the vertex at its centre
  // These list the clusters of each vertex (held ones too) and their weights, which add up to 1. Where a vertex belongs
  // to fewer than most_of_vertex clusters, the other weights are 0; if no centre reaches it, all are.
  std::vector<std::array<std::int32_t, most_of_vertex>> of;
  std::vector<std::array<double, most_of_vertex>> weight;

  int count() const { return static_cast<int>(center.size()); }
};

// Returns how many clusters a body has: enough that each of its parts can turn, and so few that their matrix costs a
// small share of a step.
int wanted_clusters(const Model& model);

// Spreads `count` clusters over the tetrahedra of a model.
Clusters make_clusters(const Model& model, int count);

}  // namespace supple
