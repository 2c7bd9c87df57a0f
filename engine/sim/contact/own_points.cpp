#include "sim/contact/own_points.h"

#include <algorithm>
#include <cmath>

#include "sim/contact/reach.h"
#include "sim/model/joined_model.h"

namespace supple {
namespace {

using Work = SurfaceWork::Parts;

// Returns what counts as near in a part [m]. A long thin solid has edges that are short beside its size.
double near_in(const Part& part, const Work::Surface& surface) {
  return part.solid ? std::min(0.01 * part.size, 0.25 * surface.edge) : surface.layer;
}

// Returns the distance from the surface within which points outside are looked at, if they come no nearer than foreseen
// [m]. A part of the body may fall on another one that rests.
double margin_of(const Model& model, const StepInputs& inputs, const Part& part, const Work::Surface& surface) {
  return near_in(part, surface) + 0.25 * model.time_step * model.time_step * inputs.gravity.norm();
}

// Returns how much nearer than foreseen points may come before they are looked for again [m]. A sheet has many pairs
// that are nearly near: a larger slack costs it more than it saves.
double slack_of(const Part& part, const Work::Surface& surface) {
  return part.solid ? near_in(part, surface) : 2 * surface.layer;
}

// Lists the points for motions from q to x.
void find_points(const Model& model, const StepInputs& inputs, const Meeting& meeting, const Positions& q,
                 const Positions& x, const Vec3& carried, Work& work) {
  const Part& part = model.parts[meeting.points];
  const Work::Surface& surface = work.surfaces[meeting.points];
  Work::OwnMemory& near = work.own_points[meeting.points];
  const Positions start = rows_of(part, q);
  near.found_for = rows_of(part, x);
  const double margin = margin_of(model, inputs, part, surface) + slack_of(part, surface);
  if (surface.own_sheet != nullptr) {
    surface.own_sheet->find_pairs(*surface.moving, start, near.found_for, margin, carried, near.of_sheet);
    return;
  }
  surface.own->find_pairs(*surface.moving, start, near.found_for, margin, carried, near.pairs);
  near.inside.clear();
  for (std::size_t i = 0; i < near.pairs.vertices.size(); ++i)
    near.inside.push_back(surface.own->place_around(*surface.moving, start, near.pairs.vertices[i], near.pairs.of(i)));
}

}  // namespace

void begin_own_points(const Model& model, const StepInputs& inputs, const Meeting& meeting, const Positions& q,
                      const Positions& y, Work& work) {
  const Work::Surface& surface = work.surfaces[meeting.points];
  surface.moving->set_end(rows_of(model.parts[meeting.points], y));
  find_points(model, inputs, meeting, q, y, surface.carried_freely, work);
}

void follow_own_points(const Model& model, const StepInputs& inputs, const Meeting& meeting, const Positions& q,
                       const Positions& x, Work& work) {
  const Part& part = model.parts[meeting.points];
  const Positions apart = rows_of(part, x) - work.own_points[meeting.points].found_for;
  const Eigen::RowVector3d mean = apart.colwise().mean();
  const double most = std::sqrt((apart.rowwise() - mean).rowwise().squaredNorm().maxCoeff());
  if (2 * most <= slack_of(part, work.surfaces[meeting.points])) return;
  find_points(model, inputs, meeting, q, x, work.surfaces[meeting.points].carried, work);
}

// Returns the place closest to a point of the iterate among some triangles, with the plane of its face where the point
// is over that.
std::optional<OwnPoints::Place> OwnPoints::place_at(std::size_t index, const Vec3& b, double most,
                                                    const Takes& takes) const {
  std::optional<Place> place = surface_.moving->closest_at_end(near_.pairs.of(index), b, most, takes);
  if (!place || !is_over_face(*place, b, x_)) return place;
  place->normal = normal_of(place->triangle, x_);
  place->distance = place->normal.dot(b - place->point);
  return place;
}

double OwnPoints::above(std::int32_t triangle, const Vec3& b) const {
  return normal_of(triangle, x_).dot(b - x_.row(corner(triangle, 0)).transpose());
}

// Points slide no further along the surface than they move.
std::optional<OwnPoints::Place> OwnPoints::leaving(const Place& before, std::size_t index, const Vec3& b,
                                                   double reach) const {
  const double moved = near_.pairs.motion[index], slides = 2 * own_.edge() + moved;
  const Takes takes = [&](std::int32_t t) { return own_.are_near_at_rest(before.triangle, t, slides); };
  const std::optional<Place> here = place_at(index, b, (1 + 1e-6) * std::max(reach, -before.distance + moved), takes);
  if (!here) return place_at_end(before.triangle, before.weights, b);
  return here->distance < reach ? here : std::nullopt;
}

std::optional<OwnPoints::Place> OwnPoints::arriving(std::size_t index, const Vec3& a, const Vec3& b,
                                                    double reach) const {
  const std::optional<Entry> entry = surface_.moving->first_entry(near_.pairs.of(index), a, b, 1);
  if (entry) {
    const std::optional<Place> entered = place_at_end(entry->triangle, entry->weights, b);
    const double moved = near_.pairs.motion[index], slides = 2 * own_.edge() + moved;
    const Takes behind = [&](std::int32_t t) {
      return own_.are_near_at_rest(entry->triangle, t, slides) && above(t, b) < 0;
    };
    std::optional<Place> here = place_at(index, b, moved, behind);
    if (here && here->distance > 0) here->distance = -here->distance;
    if (here && entered && here->distance > entered->distance) return here;
    if (entered && entered->distance < 0) return entered;
  }
  const Takes before = [&](std::int32_t t) { return above(t, b) >= 0; };
  const std::optional<Place> near = place_at(index, b, reach, before);
  return near && near->distance < reach ? near : std::nullopt;
}

void OwnPoints::find(std::size_t index, std::vector<Contact>& list) const {
  const std::int32_t v = joined_vertex(part_, near_.pairs.vertices[index]);
  const Vec3 a = q_.row(v).transpose(), b = x_.row(v).transpose();
  const double reach = reach_of(near_.pairs.motion[index], fall_);
  const std::optional<Place>& before = near_.inside[index];
  const std::optional<Place> held = before ? leaving(*before, index, b, reach) : arriving(index, a, b, reach);
  if (held) add(v, *held, before ? before->distance : reach, list);
}

double OwnPoints::share_to_impact(std::size_t index, double least) const {
  if (near_.inside[index]) return 1;
  const std::int32_t v = joined_vertex(part_, near_.pairs.vertices[index]);
  const Vec3 a = q_.row(v).transpose(), b = x_.row(v).transpose();
  const std::optional<Entry> entry = surface_.moving->first_entry(near_.pairs.of(index), a, b, least);
  return entry ? TouchedSurface::share_to_impact(*entry, a, b) : 1;
}

}  // namespace supple
