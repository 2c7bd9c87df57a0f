// Finds where edges of a sheet touch edges of a solid, and sharp edges of a solid those of another one. The vertices
// alone (solid_pair.h, sheet_pair.h) let a cloth cut through a ridge of a solid between them, and two cubes sink into
// each other where an edge of one lies across an edge of the other.
//
// A ridge is an edge at which the two faces of a solid are convex. Two edges touch where the shortest way between them
// points out of the solid between both faces of its ridge; elsewhere, a vertex or a face is closer. So a solid's faces
// tell which side is the right one, also where a step begins with an edge that passes through them below the ridge.
#pragma once

#include <optional>
#include <vector>

#include "sim/contact/touched_edges.h"

namespace supple {

class SolidEdges : public TouchedEdges {
 public:
  // Tells whether the edges of a meeting are looked at: they are in that of a sheet's points with a solid, and in one
  // of the two meetings of two solids.
  static bool are_asked(const Model& model, const StepInputs& inputs, std::size_t meeting);

  SolidEdges(const Model& model, const StepInputs& inputs, std::size_t meeting, const Positions& q, const Positions& y,
             const Positions& x, const Work& work);

  // Returns how many edges are asked about; all searches have this name (surface_contacts.cpp).
  std::size_t points() const { return of_sheet_ ? own_.edges.size() : own_.sharp_edges.size(); }

  // Adds the contacts of an edge.
  void find(std::size_t index, std::vector<Contact>& list) const;

  // Returns the share of the way at which an edge that comes through a ridge is as deep as it may be; 1: it never is.
  // least: the share after which impacts do not matter.
  double share_to_impact(std::size_t index, double least) const;

 private:
  std::size_t own_edge(std::size_t index) const { return of_sheet_ ? index : std::size_t(own_.sharp_edges[index]); }
  template <class Visit>
  void visit_ridges_near(const EdgeEnds& edge, double margin, const Visit& visit) const;
  std::optional<Vec3> way_out(std::size_t edge, std::size_t ridge, const TwoEdges& pair, const Positions& x) const;
  bool passes_face(const EdgeEnds& edge, std::size_t ridge) const;
  void add_ridge(std::size_t edge, std::size_t ridge, double reach, std::vector<Contact>& list) const;

  const Part& own_part_;
  const Work::Surface& own_;
  bool of_sheet_;  // whether the edges that are asked are those of a sheet
};

}  // namespace supple
