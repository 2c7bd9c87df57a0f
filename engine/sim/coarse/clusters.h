// Divides each body of a model into overlapping clusters of vertices, whose rigid motions are the second level of
// search directions (coarse_system.h). Centres are spread by distance along the body: a bar has them along its length,
// and an ear that touches a head is far from the place that it touches. The weights are those of an embedded
// deformation graph (Sumner, Schmid, Pauly 2007, "Embedded deformation for shape manipulation", section 3): a vertex
// belongs to the nearest few centres, by (1 - d / d_most)^2 at the distance d, where d_most is that of the first centre
// to which it does not belong.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sim/model/model.h"

namespace supple {

inline constexpr int rigid_motions = 6;  // of a cluster: it shifts along and turns about each axis

struct Clusters {
  static constexpr int most_of_vertex = 3;

  std::vector<std::int32_t> center;  // by cluster: the vertex at its centre
  std::vector<int> first = {0};      // the clusters of part p of the model are first[p] .. first[p + 1] - 1
  // These list the clusters of each vertex (held ones too) and their weights, which add up to 1. Where a vertex belongs
  // to fewer than most_of_vertex clusters, the other weights are 0; if no centre reaches it, all are. A cluster of
  // weight 0 is the first of the vertex's part, or cluster 0 where the part has none.
  std::vector<std::array<std::int32_t, most_of_vertex>> of;
  std::vector<std::array<double, most_of_vertex>> weight;

  int count() const { return static_cast<int>(center.size()); }
};

// Returns how many clusters each part of a model should have: enough that every limb of a body can turn, and so few
// that their matrix costs a small share of a step. Cloth of springs has none.
std::vector<int> wanted_clusters(const Model& model);

// Spreads clusters over the tetrahedra and triangles of a model. counts: the largest number of clusters of each part.
Clusters make_clusters(const Model& model, const std::vector<int>& counts);

}  // namespace supple
