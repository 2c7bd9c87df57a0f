// Finds the contacts of a sheet with itself (own_sheet.h). Each pair is looked at by itself, so that a part between two
// others is held by both: a vertex over a triangle, and two edges that cross, stay on the sides on which they begin the
// step, or from which the vertex comes through.
#pragma once

#include "sim/contact/touched_edges.h"

namespace supple {

class OwnSheetPoints : public TouchedEdges {
 public:
  // The pairs must have been found for x (own_points.h).
  OwnSheetPoints(const Model& model, const StepInputs& inputs, const Meeting& meeting, const Positions& q,
                 const Positions& y, const Positions& x, const Work& work)
      : TouchedEdges(model, inputs, meeting, q, y, x, work, 0.5 * work.surfaces[meeting.surface].layer),
        pairs_(work.own_points[meeting.points].of_sheet) {}

  // Returns how many pairs are asked about, of points and of edges.
  std::size_t points() const { return pairs_.size(); }

  // Adds the contact of a pair, if there is one.
  void find(std::size_t index, std::vector<Contact>& list) const;

  // Returns the share of the way at which the two of a pair that pass through each other are as deep in the layer as
  // they may be; 1: they never are. least: the share after which impacts do not matter.
  double share_to_impact(std::size_t index, double least) const;

 private:
  void add_point(const OwnSheet::PointPair& pair, std::vector<Contact>& list) const;
  void add_edges(const OwnSheet::EdgePair& pair, std::vector<Contact>& list) const;
  double reach_of_pair(const Vec3& way, const Vec3& freely) const;

  const OwnSheet::Pairs& pairs_;
};

}  // namespace supple
