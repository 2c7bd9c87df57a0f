// Keeps a skin from stretching more than the elements that carry it. What lies outside all elements follows several of
// them; where these go apart, and no element is between them, its edges would become long shards.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "geometry/skins/embedding.h"

namespace supple {

// Lists the edges of a skin. Skin vertices at one place, as along a crease, are one node and move as one.
struct SkinLimit {
  struct Edge {
    std::int32_t from, to;                // nodes
    std::int32_t from_vertex, to_vertex;  // one skin vertex of each
    double length;                        // at rest [m]
  };
  std::vector<Edge> edges;
  std::vector<char> movable;                // by node: whether it lies outside
  std::vector<std::int32_t> begin, copies;  // by node: its skin vertices

  // Returns the largest factor by which an edge is longer than at rest; 0 without edges.
  double largest_stretch(const Positions& skin) const;

  // Moves points until no edge is longer than `factor` times its length at rest, in at most 200 rounds. In each, a
  // point moves by the mean of what its edges that are too long ask of it, half of the excess where both ends can move
  // (as the distance constraints of position-based dynamics: Mueller, Heidelberger, Hennix, Ratcliff 2007, section 3.3;
  // the mean makes the order of the edges not count). A point in an element stays where this carries it, unless an edge
  // that is too long joins it with another such point, or is still too long after 50 rounds: then there is a gap
  // between elements that the points outside cannot span by themselves.
  void apply(double factor, Positions& skin) const;
};

// Returns the limit of a skin; nothing where all of it lies in elements.
std::optional<SkinLimit> skin_limit(const TriMesh& skin, const Embedding& embedding);

}  // namespace supple
