// Makes contacts of edges with edges at one iterate. Contacts between edges of sheets, of two or of the same one, are
// made here as a whole; of contacts with edges of a solid, only what all contacts of edges share. Which edges may touch
// is found elsewhere (sheet_edges.h, own_sheet_points.h, solid_edges.h).
#pragma once

#include <vector>

#include "geometry/triangles/two_edges.h"
#include "sim/contact/touched_surface.h"

namespace supple {

class TouchedEdges : public TouchedSurface {
 protected:
  // layer: how far apart the edges are kept [m].
  TouchedEdges(const Model& model, const StepInputs& inputs, const Meeting& meeting, const Positions& q,
               const Positions& y, const Positions& x, const Work& work, double layer)
      : TouchedSurface(model, inputs, meeting, q, y, x, work), layer_(layer), deepest_at_impact_(-0.5 * layer) {}

  // Returns how far from the surface an edge needs a plane [m].
  double reach_of_edge(const EdgeEnds& edge) const;

  // Calls visit(number) for each edge of the surface to which an edge may come nearer than `margin` [m]. An edge is in
  // the boxes of all triangles that have it, so that one of them is enough.
  template <class Visit>
  void visit_edges_near(const EdgeEnds& edge, double margin, const Visit& visit) const {
    const auto visit_of = [&](std::int32_t t) {
      const auto first = surface_.edge_begin[std::size_t(t)], end = surface_.edge_begin[std::size_t(t) + 1];
      for (auto e = first; e < end; ++e) visit(std::size_t(e));
    };
    surface_.moving->visit_triangles_near({q_.row(edge[0]), q_.row(edge[1])}, {x_.row(edge[0]), x_.row(edge[1])},
                                          surface_.carried, margin, visit_of);
  }

  // Adds the contact of two edges of sheets, if there is one. reach: how far apart they need a plane [m]. Edges that
  // pass through each other twice in a step are taken as if they did not.
  void add_edges(const EdgeEnds& edge, const EdgeEnds& other, double reach, std::vector<Contact>& list) const;

  // Adds the contact of two edges with the plane through the closest place of the other edge. end: both edges at the
  // iterate; field: the distance above the layer where the step began [m].
  void add_pair(const EdgeEnds& edge, const EdgeEnds& other, const TwoEdges& end, const Vec3& normal, double field,
                std::vector<Contact>& list) const;

  // Returns the share of the way at which edges that pass through each other are as deep as they may be, or `least` if
  // that comes first.
  double share_to_impact(const EdgeEnds& edge, const EdgeEnds& other, double least) const;

  double layer_;              // [m]
  double deepest_at_impact_;  // how far edges may go beyond where they pass each other; negative: before that [m]
};

}  // namespace supple
