// Finds the contacts of a part with itself: points of its surface against triangles of it that are not near them in the
// mesh (own_surface.h). A point that begins a step outside is held by what it comes through, or is near to on the
// outside; one that begins inside, by the part of the surface out of which its way was shortest.
#pragma once

#include "sim/contact/touched_surface.h"

namespace supple {

class OwnPoints : public TouchedSurface {
 public:
  // The part's points must have been followed to x.
  OwnPoints(const Model& model, const StepInputs& inputs, const Meeting& meeting, const Positions& q,
            const Positions& y, const Positions& x, const Work& work)
      : TouchedSurface(model, inputs, meeting, q, y, x, work),
        own_(*surface_.own),
        near_(work.own_points[meeting.points]) {}

  std::size_t points() const { return near_.pairs.vertices.size(); }

  // Adds the contact of a point, if there is one. index: of the point among those that may touch.
  void find(std::size_t index, std::vector<Contact>& list) const;

  // Returns the share of the way at which a point that arrives is deeper than it may be; 1: it never is. least: later
  // impacts do not matter.
  double share_to_impact(std::size_t index, double least) const;

 private:
  using Takes = MovingSurface::Takes;

  double above(std::int32_t triangle, const Vec3& b) const;
  std::optional<Place> place_at(std::size_t index, const Vec3& b, double most, const Takes& takes) const;
  std::optional<Place> leaving(const Place& before, std::size_t index, const Vec3& b, double reach) const;
  std::optional<Place> arriving(std::size_t index, const Vec3& a, const Vec3& b, double reach) const;

  const OwnSurface& own_;
  const Work::OwnPoints& near_;
};

// Finds which points of a part, a solid or a sheet, may touch it in a step that begins, and which of them are inside.
void begin_own_points(const Model& model, const StepInputs& inputs, const Meeting& meeting, const Positions& q,
                      const Positions& y, SurfaceWork::Parts& work);

// Finds them again for an iterate whose motion is another one than was foreseen. The part's surface must be at x.
void follow_own_points(const Model& model, const StepInputs& inputs, const Meeting& meeting, const Positions& q,
                       const Positions& x, SurfaceWork::Parts& work);

}  // namespace supple
