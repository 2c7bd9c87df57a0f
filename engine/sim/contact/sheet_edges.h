// Finds where edges of a sheet touch edges of another one: at borders, and between vertices that lie beside each
// other's triangles. With the vertices alone (sheet_pair.h), two narrow strips that cross each other would pass through
// each other, and so would the borders of wide ones. Of two edges, the way through the step decides which one is above
// (geometry/triangles/two_edges.h).
#pragma once

#include <vector>

#include "sim/contact/touched_edges.h"

namespace supple {

class SheetEdges : public TouchedEdges {
 public:
  // Tells whether the edges of a meeting are looked at: they are in one of the two meetings of two sheets.
  static bool are_asked(const Model& model, const StepInputs& inputs, std::size_t meeting);

  SheetEdges(const Model& model, const StepInputs& inputs, std::size_t meeting, const Positions& q, const Positions& y,
             const Positions& x, const Work& work);

  // Returns how many edges are asked about; all searches have this name (surface_contacts.cpp).
  std::size_t points() const { return own_.edges.size(); }

  // Adds the contacts of an edge.
  void find(std::size_t index, std::vector<Contact>& list) const;

  // Returns the share of the way at which an edge that crosses others is as deep in their layer as it may be; 1: it
  // never is. least: the share after which impacts do not matter.
  double share_to_impact(std::size_t index, double least) const;

 private:
  const Work::Surface& own_;
};

}  // namespace supple
