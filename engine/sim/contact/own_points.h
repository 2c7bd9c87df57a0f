// Finds the contacts of a solid with itself: of points of its surface with those of its triangles that are not near
// them in the mesh (own_surface.h). A point that begins a step outside is held by the triangle through which it comes,
// or by the closest one that it is in front of. A point that begins inside is held by the part of the surface out of
// which its way was shortest. The functions at the end also serve sheets, whose contacts with themselves are in
// own_sheet_points.h.
#pragma once

#include "sim/contact/touched_surface.h"

namespace supple {

class OwnPoints : public TouchedSurface {
 public:
  // follow_own_points() must have been called for x.
  OwnPoints(const Model& model, const StepInputs& inputs, const Meeting& meeting, const Positions& q,
            const Positions& y, const Positions& x, const Work& work)
      : TouchedSurface(model, inputs, meeting, q, y, x, work),
        own_(*surface_.own),
        near_(work.own_points[meeting.points]) {}

  std::size_t points() const { return near_.pairs.vertices.size(); }

  // Adds the contact of a point, if there is one. index: the number of the point among those that may touch.
  void find(std::size_t index, std::vector<Contact>& list) const;

  // Returns the share of the way at which a point that arrives is deeper than it may be; 1: it never is. least: the
  // share after which impacts do not matter.
  double share_to_impact(std::size_t index, double least) const;

 private:
  using Takes = MovingSurface::Takes;

  double above(std::int32_t triangle, const Vec3& b) const;
  std::optional<Place> place_at(std::size_t index, const Vec3& b, double most, const Takes& takes) const;
  std::optional<Place> leaving(const Place& before, std::size_t index, const Vec3& b, double reach) const;
  std::optional<Place> arriving(std::size_t index, const Vec3& a, const Vec3& b, double reach) const;

  const OwnSurface& own_;
  const Work::OwnMemory& near_;
};

// Finds which points of a part, or pairs of a sheet, may touch the part itself in a step that begins, and which points
// are inside.
void begin_own_points(const Model& model, const StepInputs& inputs, const Meeting& meeting, const Positions& q,
                      const Positions& y, SurfaceWork::Parts& work);

// Finds these again for an iterate, if the motion to it departs too far from the one for which they were found. The
// part's surface must be at x.
void follow_own_points(const Model& model, const StepInputs& inputs, const Meeting& meeting, const Positions& q,
                       const Positions& x, SurfaceWork::Parts& work);

}  // namespace supple
