#include "sim/contact/solid_pair.h"

#include <algorithm>
#include <cmath>

#include "sim/contact/usual_depth.h"
#include "sim/model/joined_model.h"

namespace supple {
namespace {

constexpr double deepest = 0.5;     // points that begin a step deeper than this are not found, over the body's size
constexpr double on_surface = 0.1;  // of the usual depth; a point that is no further outside may count as inside

}  // namespace

SolidPair::SolidPair(const Model& model, const StepInputs& inputs, std::size_t meeting, const Positions& q,
                     const Positions& y, const Positions& x, Work& work)
    : TouchedSurface(model, inputs, inputs.meetings[meeting], q, y, x, work),
      own_(work.surfaces[meeting_.points]),
      points_(own_.points),
      beginnings_(work.beginnings[meeting]),
      only_sharp_(work.only_sharp[meeting] != 0),
      common_(work.common_ways[meeting]),
      layer_(own_.layer) {
  beginnings_.resize(points_.size());
}

void SolidPair::find(std::size_t index, std::vector<Contact>& list) const {
  if (!is_looked_at(index)) return;
  const std::int32_t v = points_[index];
  const Vec3 a = q_.row(v).transpose(), b = x_.row(v).transpose();
  const double way = (b - a - surface_.carried).norm();
  const double near = reach_at(v, way), reach = near + most_layer();
  const bool is_near = surface_.moving->is_near(a, b, surface_.carried, reach);
  if (!is_near && !is_in_box(a)) return;
  const std::optional<Place>& before = beginning(index, a);
  if (!is_near && (!before || before->distance >= 0)) return;
  if (common_.length > 0 && before && before->distance <= 0 && leave_commonly(v, a, reach, list)) return;
  double field = before ? before->distance : reach;
  std::optional<Place> held;
  if (before && field > 0) held = resting(*before, v, a, b);
  if (!held) {
    held = field <= 0 ? leaving(*before, v, b, reach, way)
                      : arriving(v, a, b, reach, way, beginnings_[index].nearest, field);
  }
  if (!held) return;
  const double layer = layer_at(v, *held);
  if (held->distance < near + layer) add(v, *held, field - layer, list, layer);
}

double SolidPair::share_to_impact(std::size_t index, double least) const {
  if (!is_looked_at(index)) return 1;
  const std::int32_t v = points_[index];
  const Vec3 a = q_.row(v).transpose(), b = x_.row(v).transpose();
  if (!surface_.moving->is_near(a, b, surface_.carried, most_layer())) return 1;
  const std::optional<Place>& before = beginning(index, a);
  if (before && before->distance <= layer_at(v, *before)) return 1;
  const std::optional<Entry> entry = surface_.moving->first_entry(a, b, surface_.carried, least);
  if (!entry) return before ? share_to_layer(v, *before, b) : 1;
  const Place entered{entry->triangle, entry->weights, Vec3::Zero(), 0, entry->normal};
  return TouchedSurface::share_to_impact(*entry, a, b, layer_at(v, entered));
}

// Returns the share of the way at which a point that stays outside is deeper in the layer than it may be; 1: it never
// is. before: the place that is closest to it where the step begins.
double SolidPair::share_to_layer(std::int32_t v, const Place& before, const Vec3& b) const {
  const double allowed = usual_depth(size_), most = most_layer();
  if (most <= allowed) return 1;
  const std::optional<Place> here = closest(v, b, most - allowed);
  if (!here) return 1;
  const double end = std::max(0.0, layer_at(v, *here) - allowed);
  if (here->distance >= end || before.distance <= end) return 1;
  return (before.distance - end) / (before.distance - here->distance);
}

// Tells whether the points' own surface is that of a solid, which faces outward.
bool SolidPair::faces() const { return own_.moving != nullptr && model_.parts[meeting_.points].solid; }

// Tells whether a place is in the box of the surface where the step began: only then may it be inside, far from all
// triangles.
bool SolidPair::is_in_box(const Vec3& a) const {
  const Bounds& box = surface_.moving->bounds_at_start();
  return (a.array() >= box.lower.array()).all() && (a.array() <= box.upper.array()).all();
}

// Returns the place closest to a point where the step began.
const std::optional<MovingSurface::Place>& SolidPair::beginning(std::size_t index, const Vec3& a) const {
  Work::Beginning& known = beginnings_[index];
  if (known.is_known) return known.place;
  const Part& own = model_.parts[meeting_.points];
  const Vec3 facing =
      faces() ? own_.moving->normal_at_start(own_vertex(model_, own, points_[index])) : Vec3(Vec3::Zero());
  const auto find = [&](const Takes* takes) {
    return surface_.moving->closest_at_start(a, deepest * part_.size, takes);
  };
  known.place = closest(a, facing, q_, find, &known.nearest);
  known.is_known = true;
  return known.place;
}

const MovingSurface::Place* SolidPair::beginning_inside(std::size_t index) const {
  if (!is_looked_at(index)) return nullptr;
  const Vec3 a = q_.row(points_[index]).transpose();
  if (!is_in_box(a)) return nullptr;
  const std::optional<Place>& place = beginning(index, a);
  return place && place->distance <= 0 ? &*place : nullptr;
}

// Returns how far from the surface contact begins between a point and a place [m]. A sheet's layer and the overhangs of
// what is drawn do not add up: the larger one counts.
double SolidPair::layer_at(std::int32_t v, const Place& place) const {
  return std::max(layer_, model_.overhang_at(v) + overhang_at(place));
}

// Returns the way that a point faces at an iterate; zero for a point of a sheet.
Vec3 SolidPair::facing_at_end(std::int32_t v) const {
  if (!faces()) return Vec3::Zero();
  return own_.moving->normal_at_end(own_vertex(model_, model_.parts[meeting_.points], v));
}

// Returns the place closest to a point of an iterate.
std::optional<MovingSurface::Place> SolidPair::closest(std::int32_t v, const Vec3& b, double most) const {
  return closest(b, facing_at_end(v), x_,
                 [&](const Takes* takes) { return surface_.moving->closest_at_end(b, most, takes); });
}

// Returns the place closest to a point among those that do not face the way that the point's own surface does.
// find(takes): the closest place among some triangles; nearest: gets the distance of the surface, whichever way it
// faces [m]. Whether the point is inside follows from the place that is closest of all, unless the point is on the
// surface there, as the lower edges of a box are on the sides of an equal box on which it lies.
template <class Find>
std::optional<MovingSurface::Place> SolidPair::closest(const Vec3& p, const Vec3& facing, const Positions& x,
                                                       const Find& find, double* nearest) const {
  std::optional<Place> place = find(nullptr);
  if (!place) return place;
  if (nearest != nullptr) *nearest = std::abs(place->distance);
  const bool is_outside = place->distance > on_surface * usual_depth(size_);
  if (normal_of(place->triangle, x).dot(facing) > same_way) {
    const Takes others = [&](std::int32_t t) { return !(normal_of(t, x).dot(facing) > same_way); };
    place = find(&others);
    if (!place) return place;
  }
  const bool is_kept_away = surface_.overhang + own_.overhang > 0 && is_outside;
  if (!is_kept_away && is_over_face(*place, p, x)) {
    place->normal = normal_of(place->triangle, x);
    place->distance = place->normal.dot(p - place->point);
  } else if (is_outside && place->distance < 0) {
    place->normal = (p - place->point).normalized();
    place->distance = -place->distance;
  }
  return place;
}

// Adds the contact of a point that leaves with all the others; tells whether the common way leads it out. The contact's
// normal is along that way, so that both forces act along one line whatever the triangle there does.
bool SolidPair::leave_commonly(std::int32_t v, const Vec3& a, double reach, std::vector<Contact>& list) const {
  const Vec3 way = common_.length * common_.direction;
  const std::optional<Entry> exit = surface_.moving->last_exit_at_start(a, a + way);
  if (!exit) return false;
  const Place place{exit->triangle, exit->weights, Vec3::Zero(), 0, common_.direction};
  const ContactStencil stencil = stencil_of(v, place);
  const double layer = layer_at(v, place);
  if (common_.direction.dot(stencil.at(x_)) < reach)
    add(stencil, v, common_.direction, -exit->share * common_.length - layer, list, layer);
  return true;
}

// Returns the place that holds a point which begins the step outside, in the layer where contact begins, and hardly
// moves beside the surface: the one that is closest to it at the beginning. Above a hollow, which place is closest may
// change with every iterate, and the normal with it, so that what rests there never comes to rest.
std::optional<MovingSurface::Place> SolidPair::resting(const Place& before, std::int32_t v, const Vec3& a,
                                                       const Vec3& b) const {
  constexpr double hardly = 0.25;  // of the layer
  if (layer_ + surface_.overhang + own_.overhang == 0) return std::nullopt;
  const double layer = layer_at(v, before);
  if (before.distance > (1 + hardly) * layer) return std::nullopt;
  std::optional<Place> place = place_at_end(before.triangle, before.weights, b);
  if (!place || ((b - place->point) - (a - before.point)).norm() > hardly * layer) return std::nullopt;
  const Vec3 turned = before.normal + place->normal - normal_of(before.triangle, q_);
  if (!(turned.norm() > 0)) return std::nullopt;
  place->normal = turned.normalized();
  place->distance = place->normal.dot(b - place->point);
  return place;
}

// Finds the place that holds a point which began the step inside.
std::optional<MovingSurface::Place> SolidPair::leaving(const Place& before, std::int32_t v, const Vec3& b, double reach,
                                                       double way) const {
  const double most = std::max(reach, -before.distance + way + 2 * surface_.own_move);
  const std::optional<Place> here = closest(v, b, (1 + 1e-6) * most);
  if (!here) return std::nullopt;
  if (here->distance >= reach) return std::nullopt;
  if (here->distance >= 0 || here->normal.dot(normal_of(before.triangle, x_)) > 0) return here;
  return place_at_end(before.triangle, before.weights, b);
}

// Finds the place that holds a point which began the step outside: where it came in, or what is closest on that side.
// A point that is outside again may have cut a corner; if it left on the far side, it is held where it came in.
// field: the distance where the step began, which becomes that of the end where a point is inside and never came in:
// beside sharp features, and where surfaces cross themselves, the side at the beginning is not sure.
std::optional<MovingSurface::Place> SolidPair::arriving(std::int32_t v, const Vec3& a, const Vec3& b, double reach,
                                                        double way, double nearest, double& field) const {
  const double moved = way + 2 * surface_.own_move;
  const Vec3 facing = facing_at_end(v);
  const Takes takes = [&](std::int32_t t) { return !(normal_of(t, x_).dot(facing) > same_way); };
  const std::optional<Entry> entry =
      nearest <= moved ? surface_.moving->first_entry(a, b, surface_.carried, 1, &takes) : std::nullopt;
  const std::optional<Place> here = closest(v, b, std::max(reach, entry ? moved : 0));
  const std::optional<Place> near = here && here->distance < reach ? here : std::nullopt;
  if (!entry) {
    if (near) field = std::min(field, near->distance);
    return near;
  }
  const std::optional<Place> entered = place_at_end(entry->triangle, entry->weights, b);
  if (!entered) return near;
  if (here && here->distance < 0) return is_held_by(*entered, *here) ? entered : here;
  const std::optional<Entry> exit = surface_.moving->last_exit(a, b, surface_.carried);
  const bool left_on_far_side = exit && normal_of(exit->triangle, x_).dot(entered->normal) < opposite;
  return left_on_far_side ? entered : near;
}

// Tells whether a point inside is held by the place where it came in, rather than by the closest one: where the two
// are on opposite sides, or beside each other unless the closest one is many times nearer.
bool SolidPair::is_held_by(const Place& entered, const Place& closest) {
  constexpr double far_deeper = 10, one_side = 0.5;
  const double cosine = closest.normal.dot(entered.normal);
  return cosine < opposite || (cosine < one_side && entered.distance > far_deeper * closest.distance);
}

}  // namespace supple
