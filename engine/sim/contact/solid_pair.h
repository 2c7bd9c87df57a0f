// Finds the contacts of points of a part with another one that is a solid, at one iterate. A point that begins a step
// outside is held by the triangle through which it comes in, or by the closest place on that side; one that begins
// inside, by the closest place, or by the one to which the common way of its part leads (common_way.h).
#pragma once

#include <algorithm>

#include "sim/contact/touched_surface.h"

namespace supple {

class SolidPair : public TouchedSurface {
 public:
  // meeting: its number in the inputs. The list of where its points begin (work.beginnings) is filled as they are
  // asked.
  SolidPair(const Model& model, const StepInputs& inputs, std::size_t meeting, const Positions& q, const Positions& y,
            const Positions& x, Work& work);

  std::size_t points() const { return points_.size(); }

  // Adds the contact of a point, if there is one. index: the number of the point among those of its part.
  void find(std::size_t index, std::vector<Contact>& list) const;

  // Returns the share of the way at which a point that arrives is deeper than it may be; 1: it never is. least: the
  // share after which impacts do not matter.
  double share_to_impact(std::size_t index, double least) const;

  // Returns the place closest to a point that begins the step inside; null for one that does not, or is not asked.
  const Place* beginning_inside(std::size_t index) const;
  bool is_looked_at(std::size_t index) const { return !only_sharp_ || own_.sharp[index] != 0; }

 private:
  using Takes = MovingSurface::Takes;

  double share_to_layer(std::int32_t v, const Place& before, const Vec3& b) const;
  bool faces() const;
  bool is_in_box(const Vec3& a) const;
  const std::optional<Place>& beginning(std::size_t index, const Vec3& a) const;
  double layer_at(std::int32_t v, const Place& place) const;
  double most_layer() const { return std::max(layer_, own_.overhang + surface_.overhang); }  // of any place [m]
  Vec3 facing_at_end(std::int32_t v) const;
  std::optional<Place> closest(std::int32_t v, const Vec3& b, double most) const;
  template <class Find>
  std::optional<Place> closest(const Vec3& p, const Vec3& facing, const Positions& x, const Find& find,
                               double* nearest = nullptr) const;
  bool leave_commonly(std::int32_t v, const Vec3& a, double reach, std::vector<Contact>& list) const;
  std::optional<Place> resting(const Place& before, std::int32_t v, const Vec3& a, const Vec3& b) const;
  std::optional<Place> leaving(const Place& before, std::int32_t v, const Vec3& b, double reach, double way) const;
  std::optional<Place> arriving(std::int32_t v, const Vec3& a, const Vec3& b, double reach, double way, double nearest,
                                double& field) const;
  static bool is_held_by(const Place& entered, const Place& closest);

  const Work::Surface& own_;
  const std::vector<std::int32_t>& points_;
  std::vector<Work::Beginning>& beginnings_;
  bool only_sharp_;
  const Work::CommonWay& common_;
  double layer_;  // how far the points of a sheet are kept from a solid; 0 for those of a solid [m]
};

}  // namespace supple
