// Carries a drawn surface that has more vertices than the mesh below it: each of them is a weighted mean of the mesh's.
// The weights of cloth come from loop_subdivision.h; skins that lie in tetrahedra are carried by embedding.h.
#pragma once

#include <cstdint>
#include <vector>

#include "base/types.h"

namespace supple {

// Tells how the vertices of a drawn surface follow from those of the mesh: a sparse matrix by rows, each of which sums
// to 1. It is empty where a surface is not subdivided.
struct SurfaceWeights {
  std::vector<std::int32_t> begin;   // by drawn vertex, and one more: its first entry
  std::vector<std::int32_t> vertex;  // by entry: a vertex of the mesh
  std::vector<double> weight;        // by entry

  Eigen::Index rows() const { return begin.empty() ? 0 : static_cast<Eigen::Index>(begin.size()) - 1; }
};

// Returns the place of a drawn vertex at the mesh's positions [m].
Vec3 weighted_point(const SurfaceWeights& weights, Eigen::Index row, const Positions& mesh);

// Returns the value at a drawn vertex of a field that is given by mesh vertex. It does not lie beyond the values from
// which it follows, and is NaN where one of them is.
double weighted_value(const SurfaceWeights& weights, Eigen::Index row, const std::vector<double>& by_vertex);

}  // namespace supple
