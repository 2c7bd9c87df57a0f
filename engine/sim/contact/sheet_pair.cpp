#include "sim/contact/sheet_pair.h"

#include <algorithm>
#include <cmath>

#include "sim/model/joined_model.h"

namespace supple {

SheetPair::SheetPair(const Model& model, const StepInputs& inputs, std::size_t meeting, const Positions& q,
                     const Positions& y, const Positions& x, Work& work)
    : TouchedSurface(model, inputs, inputs.meetings[meeting], q, y, x, work),
      own_(work.surfaces[meeting_.points]),
      points_(own_.points),
      sharp_(work.only_sharp[meeting] != 0 ? &own_.sharp : nullptr),
      beside_(work.beside_sheets[meeting]),
      layer_(surface_.layer) {
  beside_.resize(points_.size());
}

bool SheetPair::is_looked_at(std::size_t index) const { return sharp_ == nullptr || (*sharp_)[index] != 0; }

// Returns on which side of the sheet a point is: 1 in front, -1 behind, 0 beyond its border.
double SheetPair::side_of(const Place& place, const Vec3& p, const Positions& x) const {
  constexpr double beside = 0.5;  // cosine, of the way to the border and the sheet's normal
  const Vec3 away = p - place.point;
  const double above = normal_of(place.triangle, x).dot(away);
  if (std::abs(above) < beside * away.norm()) return 0;
  return above >= 0 ? 1 : -1;
}

// Tells whether a place of the sheet is within the solid to which a point belongs, when the step begins: then the point
// has come through the sheet. The line from the point to the place leads into the solid, and does not leave it again.
bool SheetPair::is_within_own(std::int32_t v, const Vec3& a, const Place& before) const {
  constexpr double inward = -0.3;  // cosine, of the line and the point's normal
  const Part& own = model_.parts[meeting_.points];
  if (!own.solid || own_.moving == nullptr) return false;
  const Vec3 line = before.point - a;
  if (own_.moving->normal_at_start(own_vertex(model_, own, v)).dot(line) >= inward * line.norm()) return false;
  return !own_.moving->last_exit_at_start(a, before.point).has_value();
}

// Finds where the point is when the step begins, unless that is known. The answer is the same at all iterates, and is
// found once for all distances up to twice the one that is asked for.
void SheetPair::look_at_start(std::int32_t v, const Vec3& a, double most, Work::BesideSheet& known) const {
  constexpr double ahead = 2;  // looks so many times as far, because later iterates may ask further
  if (std::isfinite(known.distance) && known.asked >= 0) return;
  if (known.asked >= most) return;
  known.asked = ahead * most;
  known.distance = infinity;
  const std::optional<Place> place = surface_.moving->closest_at_start(a, known.asked);
  if (!place) return;
  known.distance = std::abs(place->distance);
  known.side = is_within_own(v, a, *place) ? -side_of(*place, a, q_) : side_of(*place, a, q_);
  known.above = normal_of(place->triangle, q_).dot(a - place->point);
}

// The triangle that was closest at the iterate before is a bound for the distance, which saves most of the search and
// changes no answer.
void SheetPair::find(std::size_t index, std::vector<Contact>& list) const {
  constexpr double beyond_roundoff = 1 + 1e-9;
  if (!is_looked_at(index)) return;
  const std::int32_t v = points_[index];
  const Vec3 a = q_.row(v).transpose(), b = x_.row(v).transpose();
  const double layer = std::max(layer_, model_.overhang_at(v));
  const double way = (b - a - surface_.carried).norm(), reach = reach_at(v, way) + layer;
  Work::BesideSheet& known = beside_[index];
  const double bound = known.last < 0 ? infinity : beyond_roundoff * surface_.moving->distance_at_end(known.last, b);
  if (bound > reach && !surface_.moving->is_near(a, b, surface_.carried, reach)) return;
  const double moved = way + 2 * surface_.own_move;
  look_at_start(v, a, reach + moved, known);
  const bool began_near = known.distance <= reach + moved;
  const std::optional<Entry> crossing = surface_.moving->first_crossing(a, b, surface_.carried);
  std::optional<Place> place = surface_.moving->closest_at_end(b, std::min(crossing ? reach + moved : reach, bound));
  if (!place) return;
  known.last = place->triangle;
  double side = began_near ? known.side : 0;
  if (crossing) {
    // The crossing's normal is the triangle's, or the opposite one where the point came from behind.
    const Vec3 then = normal_of(crossing->triangle, q_) + normal_of(crossing->triangle, x_);
    side = then.dot(crossing->normal) >= 0 ? 1 : -1;
  }
  if (side == 0) return;
  if (!crossing && side_of(*place, b, x_) == 0) return;
  place->normal = side * normal_of(place->triangle, x_);
  if (place->normal.isZero(0)) return;
  place->distance = place->normal.dot(b - place->point) - layer;
  if (place->distance >= reach) return;
  const double field = began_near && !crossing ? side * known.above - layer : 0;
  add(v, *place, began_near ? field : reach, list, layer);
}

double SheetPair::share_to_impact(std::size_t index, double least) const {
  if (!is_looked_at(index)) return 1;
  const std::int32_t v = points_[index];
  const Vec3 a = q_.row(v).transpose(), b = x_.row(v).transpose();
  if (!surface_.moving->is_near(a, b, surface_.carried, 0)) return 1;
  const std::optional<Entry> crossing = surface_.moving->first_crossing(a, b, surface_.carried, least);
  if (!crossing) return 1;
  const double falls = way_into(*crossing, a, b);
  return falls > 0 ? std::max(0.0, crossing->share - (1 - deepest) * layer_ / falls) : 1;
}

}  // namespace supple
