// Counts how often triangles pass through each other: the measure of cloth that has gone through cloth, which neither
// depths nor contacts show, because a sheet has no inside.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "base/types.h"
#include "geometry/meshes/mesh.h"
#include "geometry/triangles/moving_surface.h"

namespace supple {

class EdgeCrossings {
 public:
  // triangles: those of one surface or of several, m x 3, at least one. rest: their vertices, n x 3 [m].
  EdgeCrossings(const Triangles& triangles, const Positions& rest);

  // Counts pairs of an edge and a triangle without a common vertex, of which the edge passes through the triangle's
  // inside.
  struct Count {
    std::int64_t apart = 0;   // pairs of which no edge joins a vertex of the one to a vertex of the other
    std::int64_t beside = 0;  // pairs of which an edge does: at a sharp fold or at the tip of a cone
  };
  // Counts the pairs where the vertices are at x, n x 3 [m].
  Count count(const Positions& x);

 private:
  using Edge = std::array<std::int32_t, 2>;
  bool share_vertex(const Edge& edge, std::int32_t triangle) const;
  bool are_beside(const Edge& edge, std::int32_t triangle) const;
  bool passes(const Edge& edge, std::int32_t triangle, const Positions& x) const;

  Triangles triangles_;
  MovingSurface moving_;
  std::vector<Edge> edges_;  // sorted
};

}  // namespace supple
