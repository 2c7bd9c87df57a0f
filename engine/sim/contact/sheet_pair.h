// Finds the contacts of points of a part with another one that is a sheet, such as cloth: a surface without inside,
// with a thin layer on both sides. The layer tells on which side a point is: contact presses a point into the layer,
// but not through the sheet, so that a point is on the side on which a step finds it. On the way through a step, the
// first crossing decides. A point that begins beyond the border of a sheet is on neither side. A point of a solid that
// has the sheet inside its own solid is on the wrong side, and goes back.
#pragma once

#include "sim/contact/touched_surface.h"

namespace supple {

class SheetPair : public TouchedSurface {
 public:
  // meeting: its number in the inputs.
  SheetPair(const Model& model, const StepInputs& inputs, std::size_t meeting, const Positions& q, const Positions& y,
            const Positions& x, Work& work);

  std::size_t points() const { return points_.size(); }

  // Adds the contact of a point, if there is one. index: the number of the point among those of its part.
  void find(std::size_t index, std::vector<Contact>& list) const;

  // Returns the share of the way at which a point that crosses the sheet is as deep in its layer as it may be; 1: it
  // never is. least: the share after which impacts do not matter.
  double share_to_impact(std::size_t index, double least) const;

 private:
  static constexpr double deepest = 0.5;  // how deep a point that arrives may be in the layer, over its thickness

  double side_of(const Place& place, const Vec3& p, const Positions& x) const;
  bool is_looked_at(std::size_t index) const;
  bool is_within_own(std::int32_t v, const Vec3& a, const Place& before) const;
  void look_at_start(std::int32_t v, const Vec3& a, double most, Work::BesideSheet& known) const;

  const Work::Surface& own_;
  const std::vector<std::int32_t>& points_;
  const std::vector<char>* sharp_;          // by point: whether it is looked at; null: all are
  std::vector<Work::BesideSheet>& beside_;  // by point
  double layer_;                            // [m]
};

}  // namespace supple
