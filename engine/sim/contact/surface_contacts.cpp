#include "sim/contact/surface_contacts.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "sim/contact/contact_order.h"
#include "sim/contact/own_points.h"
#include "sim/contact/own_sheet_points.h"
#include "sim/contact/sheet_edges.h"
#include "sim/contact/sheet_pair.h"
#include "sim/contact/surface_work.h"
#include "sim/contact/touched_surface.h"
#include "sim/contact/usual_depth.h"
#include "sim/model/joined_model.h"

namespace supple {

SurfaceWork::SurfaceWork() = default;
SurfaceWork::~SurfaceWork() = default;
SurfaceWork::SurfaceWork(SurfaceWork&&) noexcept = default;
SurfaceWork& SurfaceWork::operator=(SurfaceWork&&) noexcept = default;

SurfaceWork::Parts& SurfaceWork::parts() {
  if (parts_ == nullptr) parts_ = std::make_unique<Parts>();
  return *parts_;
}

namespace {

using Work = SurfaceWork::Parts;
using Takes = MovingSurface::Takes;

constexpr int points_a_chunk = 128;  // a thread takes so many; fixed, so that results do not depend on threads
constexpr double deepest = 0.5;      // points that begin a step deeper than this are not found, over the body's size
constexpr double on_surface = 0.1;   // of the usual depth; a point that is no further outside may count as inside

// Returns the mean motion of some vertices from q to x [m].
Vec3 mean_motion(const std::vector<std::int32_t>& points, const Positions& q, const Positions& x) {
  Vec3 sum = Vec3::Zero();
  for (const std::int32_t v : points) sum += (x.row(v) - q.row(v)).transpose();
  return sum / static_cast<double>(points.size());
}

// Returns how far vertices move beside a common motion at most [m].
double most_moved(const std::vector<std::int32_t>& points, const Positions& q, const Positions& x, const Vec3& common) {
  double most = 0;
  for (const std::int32_t v : points) most = std::max(most, ((x.row(v) - q.row(v)).transpose() - common).squaredNorm());
  return std::sqrt(most);
}

// Examines the points of one part before the surface of another, at one iterate.
class SurfacePair : public TouchedSurface {
 public:
  SurfacePair(const Model& model, const StepInputs& inputs, std::size_t meeting, const Positions& q, const Positions& y,
              const Positions& x, Work& work)
      : TouchedSurface(model, inputs, inputs.meetings[meeting], q, y, x, work),
        own_(work.surfaces[meeting_.points]),
        points_(own_.points),
        beginnings_(work.beginnings[meeting]),
        only_sharp_(work.only_sharp[meeting] != 0),
        layer_(own_.layer) {
    beginnings_.resize(points_.size());
    Work::CommonWay& way = work.common_ways[meeting];
    if (!std::exchange(way.is_known, true)) way.out = common_way_out();
    common_ = &way.out;
  }

  std::size_t points() const { return points_.size(); }

  // Adds the contact of a point, if there is one. index: of the point among those of its part.
  void find(std::size_t index, std::vector<Contact>& list) const {
    if (only_sharp_ && !own_.sharp[index]) return;
    const std::int32_t v = points_[index];
    const Vec3 a = q_.row(v).transpose(), b = x_.row(v).transpose();
    const double way = (b - a - surface_.carried).norm();
    const double reach = reach_at(v, way) + layer_;
    const bool is_near = surface_.moving->is_near(a, b, surface_.carried, reach);
    if (!is_near && !is_in_box(a)) return;
    const std::optional<Place>& before = beginning(index, a);
    if (!is_near && (!before || before->distance >= 0)) return;
    if (*common_ && before && before->distance <= 0) return leave_commonly(v, a, b, reach, list);
    double field = before ? before->distance : reach;
    const std::optional<Place> held = field <= 0 ? leaving(*before, v, b, reach, way)
                                                 : arriving(v, a, b, reach, way, beginnings_[index].nearest, field);
    if (held) add(v, *held, field - layer_, list, layer_);
  }

  // Lowers a share to where a point that arrives is deeper than it may be.
  double share_to_impact(std::size_t index, double least) const {
    if (only_sharp_ && !own_.sharp[index]) return 1;
    const std::int32_t v = points_[index];
    const Vec3 a = q_.row(v).transpose(), b = x_.row(v).transpose();
    if (!surface_.moving->is_near(a, b, surface_.carried, 0)) return 1;
    const std::optional<Place>& before = beginning(index, a);
    if (before && before->distance <= 0) return 1;
    const std::optional<Entry> entry = surface_.moving->first_entry(a, b, surface_.carried, least);
    if (!entry) return 1;
    return TouchedSurface::share_to_impact(*entry, a, b);
  }

 private:
  // Tells whether the points' own surface is that of a solid, which faces outward.
  bool faces() const { return own_.moving != nullptr && model_.parts[meeting_.points].solid; }

  // Tells whether a place is in the surface's box where the step began, and may be inside, far from all triangles.
  bool is_in_box(const Vec3& a) const {
    const Bounds& box = surface_.moving->bounds_at_start();
    return (a.array() >= box.lower.array()).all() && (a.array() <= box.upper.array()).all();
  }

  // Returns the place closest to a point where the step began.
  const std::optional<Place>& beginning(std::size_t index, const Vec3& a) const {
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

  // Returns the way that a point faces at an iterate; 0 for that of a sheet.
  Vec3 facing_at_end(std::int32_t v) const {
    if (!faces()) return Vec3::Zero();
    return own_.moving->normal_at_end(own_vertex(model_, model_.parts[meeting_.points], v));
  }

  // Returns the place closest to a point of an iterate.
  std::optional<Place> closest(std::int32_t v, const Vec3& b, double most) const {
    return closest(b, facing_at_end(v), x_,
                   [&](const Takes* takes) { return surface_.moving->closest_at_end(b, most, takes); });
  }

  // Returns the place closest to a point among those that do not face the way of the point itself. find(takes): the
  // closest place among some triangles; nearest: set to how far away the surface is at all. Whether the point is inside
  // follows from the place that is closest of all, but where the point is on the surface there: the edges of equal
  // boxes that lie on one another are on their sides.
  template <class Find>
  std::optional<Place> closest(const Vec3& p, const Vec3& facing, const Positions& x, const Find& find,
                               double* nearest = nullptr) const {
    std::optional<Place> place = find(nullptr);
    if (!place) return place;
    if (nearest != nullptr) *nearest = std::abs(place->distance);
    const bool is_outside = place->distance > on_surface * usual_depth(size_);
    if (normal_of(place->triangle, x).dot(facing) > same_way) {
      const Takes others = [&](std::int32_t t) { return !(normal_of(t, x).dot(facing) > same_way); };
      place = find(&others);
      if (!place) return place;
    }
    if (is_over_face(*place, p, x)) {
      place->normal = normal_of(place->triangle, x);
      place->distance = place->normal.dot(p - place->point);
    } else if (is_outside && place->distance < 0) {
      place->normal = (p - place->point).normalized();
      place->distance = -place->distance;
    }
    return place;
  }

  // Returns the place across whose plane all points that begin the step inside leave, where a good part of them is deep
  // inside. Each would otherwise leave by what is closest to it, to all sides, and the bodies would stay, torn. Of the
  // places that are closest to the points, the one is taken whose plane all have passed first.
  std::optional<Place> common_way_out() const {
    constexpr double deep = 0.02;  // over the size of the smaller body
    constexpr std::size_t share = 8;
    std::vector<std::size_t> inside;
    std::size_t asked = 0, deep_inside = 0;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (only_sharp_ && !own_.sharp[i]) continue;
      ++asked;
      const Vec3 a = q_.row(points_[i]).transpose();
      if (!is_in_box(a)) continue;
      const std::optional<Place>& place = beginning(i, a);
      if (!place || place->distance > 0) continue;
      inside.push_back(i);
      deep_inside += place->distance < -deep * size_;
    }
    if (deep_inside == 0 || share * deep_inside < asked) return std::nullopt;
    std::optional<Place> best;
    double least = std::numeric_limits<double>::infinity();
    for (const std::size_t i : inside) {
      Place place = *beginnings_[i].place;
      place.normal = normal_of(place.triangle, q_);
      if (place.normal.isZero(0)) continue;
      double furthest = 0;
      for (const std::size_t k : inside)
        furthest = std::max(furthest, place.normal.dot(place.point - q_.row(points_[k]).transpose()));
      if (!(furthest < least)) continue;
      least = furthest;
      best = place;
    }
    return best;
  }

  // Adds the contact of a point that leaves so.
  void leave_commonly(std::int32_t v, const Vec3& a, const Vec3& b, double reach, std::vector<Contact>& list) const {
    const Place& way = **common_;
    const std::optional<Place> held = place_at_end(way.triangle, way.weights, b);
    if (held && held->distance < reach) add(v, *held, way.normal.dot(a - way.point) - layer_, list, layer_);
  }

  // Finds the place that holds a point which began the step inside.
  std::optional<Place> leaving(const Place& before, std::int32_t v, const Vec3& b, double reach, double way) const {
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
  std::optional<Place> arriving(std::int32_t v, const Vec3& a, const Vec3& b, double reach, double way, double nearest,
                                double& field) const {
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
  static bool is_held_by(const Place& entered, const Place& closest) {
    constexpr double far_deeper = 10, one_side = 0.5;
    const double cosine = closest.normal.dot(entered.normal);
    return cosine < opposite || (cosine < one_side && entered.distance > far_deeper * closest.distance);
  }

  const Work::Surface& own_;
  const std::vector<std::int32_t>& points_;
  std::vector<Work::Beginning>& beginnings_;
  bool only_sharp_;
  double layer_;  // of a sheet, which its points keep from a solid [m]
  const std::optional<Place>* common_;
};

// Moves the surfaces to the positions of an iterate.
void move_surfaces(const Model& model, const Positions& q, const Positions& x, Work& work) {
  for (std::size_t p = 0; p < work.surfaces.size(); ++p) {
    Work::Surface& surface = work.surfaces[p];
    if (surface.moving == nullptr) continue;
    surface.carried = mean_motion(surface.points, q, x);
    surface.own_move = most_moved(surface.points, q, x, surface.carried);
    surface.moving->set_end(rows_of(model.parts[p], x));
  }
}

}  // namespace

void begin_surfaces(const Model& model, const StepInputs& inputs, const Positions& q, const Positions& y,
                    SurfaceWork& all) {
  if (inputs.meetings.empty()) return;
  Work& work = all.parts();
  make_surfaces(model, inputs, work);
  for (std::size_t p = 0; p < work.surfaces.size(); ++p) {
    Work::Surface& surface = work.surfaces[p];
    if (surface.moving == nullptr) continue;
    surface.moving->set_start(rows_of(model.parts[p], q));
    surface.carried_freely = mean_motion(surface.points, q, y);
    surface.free_move = most_moved(surface.points, q, y, surface.carried_freely);
  }
  work.only_sharp = only_sharp_points(model, inputs, work);
  work.beginnings.resize(inputs.meetings.size());
  work.common_ways.assign(inputs.meetings.size(), {});
  work.own_points.resize(model.parts.size());
  for (std::size_t m = 0; m < inputs.meetings.size(); ++m) {
    const Meeting& meeting = inputs.meetings[m];
    if (meeting.is_own()) {
      begin_own_points(model, inputs, meeting, q, y, work);
    } else {
      work.beginnings[m].clear();
    }
  }
}

namespace {

// Adds what search(points, list) finds of each point in turn, on all threads; results do not depend on their number.
template <class Search>
void search_points(const Search& search, Threads* threads, Work& work, std::vector<Contact>& found) {
  const int chunks = static_cast<int>((search.points() + points_a_chunk - 1) / points_a_chunk);
  if (std::ssize(work.by_chunk) < chunks) work.by_chunk.resize(chunks);
  run_chunks(threads, chunks, long(search.points()) * 20, [&](int chunk) {
    work.by_chunk[chunk].clear();
    const std::size_t end = std::min(search.points(), std::size_t(chunk + 1) * points_a_chunk);
    for (std::size_t i = std::size_t(chunk) * points_a_chunk; i < end; ++i) search.find(i, work.by_chunk[chunk]);
  });
  for (int chunk = 0; chunk < chunks; ++chunk)
    found.insert(found.end(), work.by_chunk[chunk].begin(), work.by_chunk[chunk].end());
}

// Returns the share of the ways at which the first of all points is deeper than it may be, or `least`.
template <class Search>
double first_share(const Search& search, double least) {
  for (std::size_t i = 0; i < search.points(); ++i) least = std::min(least, search.share_to_impact(i, least));
  return least;
}

// Calls visit(search) for each search that a meeting needs at an iterate. meeting: its number in the inputs.
template <class Visit>
void visit_searches(const Model& model, const StepInputs& inputs, std::size_t meeting, const Positions& q,
                    const Positions& y, const Positions& x, Work& work, const Visit& visit) {
  const Meeting& of = inputs.meetings[meeting];
  if (of.is_own()) {
    follow_own_points(model, inputs, of, q, x, work);
    if (model.parts[of.points].solid) return visit(OwnPoints(model, inputs, of, q, y, x, work));
    return visit(OwnSheetPoints(model, inputs, of, q, y, x, work));
  }
  if (are_apart(model, inputs, of, work)) return;
  if (model.parts[of.surface].solid) return visit(SurfacePair(model, inputs, meeting, q, y, x, work));
  visit(SheetPair(model, inputs, meeting, q, y, x, work));
  if (SheetEdges::are_asked(model, inputs, meeting)) visit(SheetEdges(model, inputs, meeting, q, y, x, work));
}

}  // namespace

void find_surface_contacts(const Model& model, const StepInputs& inputs, const Positions& q, const Positions& y,
                           const Positions& x, Threads* threads, SurfaceWork& all, std::vector<Contact>& found) {
  if (inputs.meetings.empty()) return;
  Work& work = all.parts();
  move_surfaces(model, q, x, work);
  const std::size_t before = found.size();
  for (std::size_t m = 0; m < inputs.meetings.size(); ++m)
    visit_searches(model, inputs, m, q, y, x, work,
                   [&](const auto& search) { search_points(search, threads, work, found); });
  std::stable_sort(found.begin() + static_cast<std::ptrdiff_t>(before), found.end(), comes_before);
}

void stop_at_surfaces(const Model& model, const StepInputs& inputs, const Positions& q, const Positions& x,
                      SurfaceWork& all, std::vector<double>& shares) {
  if (inputs.meetings.empty()) return;
  Work& work = all.parts();
  move_surfaces(model, q, x, work);
  for (std::size_t m = 0; m < inputs.meetings.size(); ++m) {
    const Meeting& meeting = inputs.meetings[m];
    double least = std::max(shares[meeting.points], shares[meeting.surface]);
    visit_searches(model, inputs, m, q, x, x, work, [&](const auto& search) { least = first_share(search, least); });
    shares[meeting.points] = std::min(shares[meeting.points], least);
    shares[meeting.surface] = std::min(shares[meeting.surface], least);
  }
}

}  // namespace supple
