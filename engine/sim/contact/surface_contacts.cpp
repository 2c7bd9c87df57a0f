#include "sim/contact/surface_contacts.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "geometry/triangles/moving_surface.h"
#include "sim/contact/contact_order.h"
#include "sim/contact/lagged_force.h"
#include "sim/contact/reach.h"
#include "sim/contact/usual_depth.h"
#include "sim/model/joined_model.h"

namespace supple {

struct SurfaceWork::Parts {
  struct Surface {
    Triangles triangles;                    // rows of its part's vertices, in the order of the part's own model
    std::vector<std::int32_t> points;       // vertices of the joined model that may touch others, ascending
    std::vector<char> sharp;                // by point: whether faces at it look in very different directions at rest
    double edge = 0;                        // the mean length of the surface's edges at rest [m]
    std::unique_ptr<MovingSurface> moving;  // null where nothing touches this part
    Vec3 carried = Vec3::Zero();            // the mean motion of the part from q to the present iterate [m]
    double own_move = 0;                    // how far its vertices move beside that at most [m]
    Vec3 carried_freely = Vec3::Zero();     // the mean motion of the part from q to the prediction [m]
    double free_move = 0;                   // how far its vertices move beside that at most [m]
  };
  // Holds what is known of a point when the step begins.
  struct Beginning {
    bool is_known = false;
    std::optional<MovingSurface::Place> place;  // that may hold it; nothing: outside, far from the surface
    double nearest = 0;                         // how far away the surface is at all; 0 where it is far [m]
  };

  std::uint64_t structure = 0;                     // of the model that the surfaces belong to
  std::vector<Surface> surfaces;                   // by part
  std::vector<std::vector<Beginning>> beginnings;  // by meeting and point
  std::vector<std::vector<Contact>> by_chunk;      // scratch
};

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

using Place = MovingSurface::Place;
using Entry = MovingSurface::Entry;
using Facing = MovingSurface::Facing;

constexpr int points_a_chunk = 128;  // a thread takes so many; fixed, so that results do not depend on threads
constexpr double same_way = 0.5;     // cosine of normals; a point is not held by a face that looks as it does itself
constexpr double opposite = -0.3;    // cosine of normals below which they belong to opposite sides
constexpr double deepest = 0.5;      // points that begin a step deeper than this are not found, over the body's size

// Lists the triangles of a part, with its vertices numbered as in its own model.
Triangles triangles_of(const Model& model, const Part& part) {
  std::vector<Eigen::Index> own;
  for (Eigen::Index t = 0; t < model.surface.rows(); ++t) {
    if (&model.part_of(model.surface(t, 0)) == &part) own.push_back(t);
  }
  Triangles triangles(std::ssize(own), 3);
  for (std::size_t i = 0; i < own.size(); ++i) {
    for (int k = 0; k < 3; ++k) {
      triangles(static_cast<Eigen::Index>(i), k) = own_vertex(model, part, model.surface(own[i], k));
    }
  }
  return triangles;
}

std::vector<std::int32_t> points_of(const Part& part, const Triangles& triangles) {
  std::vector<std::int32_t> points;
  for (Eigen::Index i = 0; i < triangles.size(); ++i) points.push_back(joined_vertex(part, triangles.data()[i]));
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  return points;
}

Vec3 rest_normal(const Triangles& triangles, Eigen::Index t, const Positions& rest) {
  const Vec3 first = rest.row(triangles(t, 0)).transpose();
  const Vec3 edge = rest.row(triangles(t, 1)).transpose() - first,
             other = rest.row(triangles(t, 2)).transpose() - first;
  return edge.cross(other).normalized();
}

// Finds the points at which the normals of two faces are far apart, and the mean length of edges.
void describe_surface(const Model& model, const Part& part, Work::Surface& surface) {
  constexpr double least_cosine = 0.5;
  const Positions rest = rows_of(part, model.rest);
  const Triangles& triangles = surface.triangles;
  std::vector<std::vector<Vec3>> normals(std::size_t(rest.rows()));
  double edges = 0;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    for (int k = 0; k < 3; ++k) {
      normals[triangles(t, k)].push_back(rest_normal(triangles, t, rest));
      edges += (rest.row(triangles(t, k)) - rest.row(triangles(t, (k + 1) % 3))).norm();
    }
  }
  surface.edge = edges / std::max<double>(1, double(triangles.size()));
  for (const std::int32_t v : surface.points) {
    const std::vector<Vec3>& at = normals[own_vertex(model, part, v)];
    bool is_sharp = false;
    for (const Vec3& one : at) {
      for (const Vec3& other : at) is_sharp |= one.dot(other) < least_cosine;
    }
    surface.sharp.push_back(is_sharp);
  }
}

void make_surfaces(const Model& model, const StepInputs& inputs, Work& work) {
  if (work.structure != model.structure) {
    work.surfaces.clear();
    for (const Part& part : model.parts) {
      Work::Surface& surface = work.surfaces.emplace_back();
      surface.triangles = triangles_of(model, part);
      surface.points = points_of(part, surface.triangles);
      describe_surface(model, part, surface);
    }
  }
  work.structure = model.structure;
  for (const Meeting& meeting : inputs.meetings) {
    Work::Surface& surface = work.surfaces[meeting.surface];
    if (surface.moving != nullptr) continue;
    const Part& part = model.parts[meeting.surface];
    surface.moving = std::make_unique<MovingSurface>(surface.triangles, rows_of(part, model.rest));
  }
}

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

// Tells whether the surface's own points, which are finer, touch the other part. Then the other part's points follow
// from them, but for edges and corners: each contact of two surfaces that lie on one another would count twice, and the
// contacts would nearly depend on each other.
bool meets_finer_points(const StepInputs& inputs, const Meeting& meeting, const Work& work) {
  const bool both_ways = std::ranges::any_of(inputs.meetings, [&](const Meeting& other) {
    return other.points == meeting.surface && other.surface == meeting.points;
  });
  const double own = work.surfaces[meeting.points].edge, other = work.surfaces[meeting.surface].edge;
  return both_ways && (own > other || (own == other && meeting.points > meeting.surface));
}

// Examines the points of one part before the surface of another, at one iterate.
class Pair {
 public:
  Pair(const Model& model, const StepInputs& inputs, const Meeting& meeting, const Positions& q, const Positions& y,
       const Positions& x, Work& work, std::vector<Work::Beginning>& beginnings)
      : model_(model),
        solver_(inputs.solver),
        meeting_(meeting),
        q_(q),
        y_(y),
        x_(x),
        part_(model.parts[meeting.surface]),
        surface_(work.surfaces[meeting.surface]),
        own_(work.surfaces[meeting.points]),
        points_(work.surfaces[meeting.points].points),
        beginnings_(beginnings),
        only_sharp_(meets_finer_points(inputs, meeting, work)),
        size_(std::min(part_.size, model.parts[meeting.points].size)),
        fall_(model.time_step * model.time_step * inputs.gravity.norm()) {}

  std::size_t points() const { return points_.size(); }

  // Adds the contact of a point, if there is one. index: of the point among those of its part.
  void find(std::size_t index, std::vector<Contact>& list) const {
    if (only_sharp_ && !own_.sharp[index]) return;
    const std::int32_t v = points_[index];
    const Vec3 a = q_.row(v).transpose(), b = x_.row(v).transpose();
    const double way = (b - a - surface_.carried).norm();
    const double reach = reach_at(v, way);
    const bool is_near = surface_.moving->is_near(a, b, surface_.carried, reach);
    if (!is_near && !is_in_box(a)) return;
    const std::optional<Place>& before = beginning(index, a);
    if (!is_near && (!before || before->distance >= 0)) return;
    double field = before ? before->distance : reach;
    const std::optional<Place> held = field <= 0 ? leaving(*before, v, b, reach, way)
                                                 : arriving(v, a, b, reach, way, beginnings_[index].nearest, field);
    if (held) add(v, *held, field, list);
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
    Vec3 pace = b - a;
    for (int k = 0; k < 3; ++k) {
      const std::int32_t c = corner(entry->triangle, k);
      pace -= entry->weights[k] * (x_.row(c) - q_.row(c)).transpose();
    }
    const double falls = -entry->normal.dot(pace), allowed = usual_depth(size_);
    return falls * (1 - entry->share) > allowed ? entry->share + allowed / falls : 1;
  }

 private:
  // Tells whether a place is in the surface's box where the step began, and may be inside, far from all triangles.
  bool is_in_box(const Vec3& a) const {
    const Bounds& box = surface_.moving->bounds_at_start();
    return (a.array() >= box.lower.array()).all() && (a.array() <= box.upper.array()).all();
  }

  std::int32_t corner(std::int32_t triangle, int k) const {
    return joined_vertex(part_, surface_.triangles(triangle, k));
  }

  double reach_at(std::int32_t v, double way) const {
    const double freely = ((y_.row(v) - q_.row(v)).transpose() - surface_.carried_freely).norm();
    return reach_of(way + surface_.own_move, std::max(freely + surface_.free_move, fall_));
  }

  // Returns the place closest to a point where the step began.
  const std::optional<Place>& beginning(std::size_t index, const Vec3& a) const {
    Work::Beginning& known = beginnings_[index];
    if (known.is_known) return known.place;
    const MovingSurface* own = own_.moving.get();
    const Vec3 facing = own == nullptr
                            ? Vec3(Vec3::Zero())
                            : own->normal_at_start(own_vertex(model_, model_.parts[meeting_.points], points_[index]));
    const auto find = [&](const Facing* without) {
      return surface_.moving->closest_at_start(a, deepest * part_.size, without);
    };
    known.place = closest(a, facing, q_, find, &known.nearest);
    known.is_known = true;
    return known.place;
  }

  // Returns the place closest to a point of an iterate.
  std::optional<Place> closest(std::int32_t v, const Vec3& b, double most) const {
    const MovingSurface* own = own_.moving.get();
    const Vec3 facing =
        own == nullptr ? Vec3(Vec3::Zero()) : own->normal_at_end(own_vertex(model_, model_.parts[meeting_.points], v));
    return closest(b, facing, x_,
                   [&](const Facing* without) { return surface_.moving->closest_at_end(b, most, without); });
  }

  // Returns the place closest to a point among those that do not face the way of the point itself. find(without): the
  // closest place without some triangles; nearest: set to how far
  // away the surface is at all. Whether the point is inside follows from the place that is closest of all.
  template <class Find>
  std::optional<Place> closest(const Vec3& p, const Vec3& facing, const Positions& x, const Find& find,
                               double* nearest = nullptr) const {
    std::optional<Place> place = find(nullptr);
    if (!place) return place;
    if (nearest != nullptr) *nearest = std::abs(place->distance);
    const bool is_inside = place->distance < 0;
    if (normal_of(place->triangle, x).dot(facing) > same_way) {
      const Facing without{facing, same_way};
      place = find(&without);
      if (!place) return place;
    }
    if (is_over_face(*place, p, x)) {
      place->normal = normal_of(place->triangle, x);
      place->distance = place->normal.dot(p - place->point);
    } else if (!is_inside && place->distance < 0) {
      place->normal = (p - place->point).normalized();
      place->distance = -place->distance;
    }
    return place;
  }

  // Tells whether a point is over a place's face, and neither beside nor below it by more than the usual depth. Equal
  // boxes on one another have their edges in one place: round-off alone would decide whether a lid carries them.
  bool is_over_face(const Place& place, const Vec3& p, const Positions& x) const {
    const Vec3 normal = normal_of(place.triangle, x), offset = p - place.point;
    const double above = normal.dot(offset), beside = (offset - above * normal).norm();
    return !normal.isZero(0) && above >= -usual_depth(size_) && beside <= usual_depth(size_);
  }

  // Returns the unit normal of a triangle; zero where it has no area.
  Vec3 normal_of(std::int32_t triangle, const Positions& x) const {
    const Vec3 first = x.row(corner(triangle, 0)).transpose();
    const Vec3 edge = x.row(corner(triangle, 1)).transpose() - first;
    const Vec3 other = x.row(corner(triangle, 2)).transpose() - first;
    const Vec3 normal = edge.cross(other);
    const double length = normal.norm();
    return length > 0 ? Vec3(normal / length) : Vec3(Vec3::Zero());
  }

  // Returns the place that a triangle's point has at the end of the step.
  std::optional<Place> place_at_end(std::int32_t triangle, const Vec3& weights, const Vec3& p) const {
    Place place{triangle, weights, Vec3::Zero(), 0, normal_of(triangle, x_)};
    if (place.normal.isZero(0)) return std::nullopt;
    for (int k = 0; k < 3; ++k) place.point += weights[k] * x_.row(corner(triangle, k)).transpose();
    place.distance = place.normal.dot(p - place.point);
    return place;
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
    const std::optional<Entry> entry =
        nearest <= moved ? surface_.moving->first_entry(a, b, surface_.carried) : std::nullopt;
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

  ContactStencil stencil_of(std::int32_t point, const Place& place) const {
    constexpr double least_weight = 1e-9;
    ContactStencil stencil{};
    stencil.count = stencil.free = 0;
    double sum = 0;
    for (int k = 0; k < 3; ++k) {
      if (place.weights[k] < least_weight) continue;
      add_vertex(corner(place.triangle, k), -place.weights[k], stencil);
      sum += place.weights[k];
    }
    add_vertex(point, sum, stencil);
    return stencil;
  }

  // Adds a vertex to a stencil, before those with larger numbers.
  void add_vertex(std::int32_t vertex, double weight, ContactStencil& stencil) const {
    int at = stencil.count++;
    for (; at > 0 && stencil.vertex[at - 1] > vertex; --at) {
      stencil.vertex[at] = stencil.vertex[at - 1];
      stencil.weight[at] = stencil.weight[at - 1];
    }
    stencil.vertex[at] = vertex;
    stencil.weight[at] = weight;
    stencil.free += vertex < model_.free;
  }

  // Adds the contact with the plane through a place, lowered by as much of the depth as need not be corrected in this
  // step. field: the distance where the step began, negative inside [m].
  void add(std::int32_t v, const Place& place, double field, std::vector<Contact>& list) const {
    Contact contact{stencil_of(v, place), {-1, meeting_.surface}, place.normal, 0, 0, 0, v};
    if (contact.stencil.free == 0) return;
    const double h = model_.time_step, mass = contact.stencil.mass(model_.mass);
    const double fastest = solver_.contact.push_out * size_ * h;
    const double deep = std::max(0.0, -field - fastest);
    contact.offset = -deep;
    contact.stiffness = solver_.contact.stiffness / (h * h) * mass;
    contact.depth = std::max(0.0, -gap(contact, x_));
    if (meeting_.friction > 0) {
      contact.stick = solver_.contact.stick * size_ * h;
      contact.origin = contact.stencil.at(q_);
      contact.friction = meeting_.friction * lagged_force(contact, deep > 0 ? 0 : -field, -gap(contact, y_),
                                                          model_.scheme.inertia * mass / (h * h));
    }
    list.push_back(contact);
  }

  const Model& model_;
  const SolverSettings& solver_;
  const Meeting& meeting_;
  const Positions &q_, &y_, &x_;
  const Part& part_;
  const Work::Surface &surface_, &own_;
  const std::vector<std::int32_t>& points_;
  std::vector<Work::Beginning>& beginnings_;
  bool only_sharp_;
  double size_;  // of the smaller part [m]
  double fall_;  // in one step from rest: one part may rest on what holds it while the other falls [m]
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
  work.beginnings.resize(inputs.meetings.size());
  for (std::size_t m = 0; m < inputs.meetings.size(); ++m)
    work.beginnings[m].assign(work.surfaces[inputs.meetings[m].points].points.size(), {});
}

void find_surface_contacts(const Model& model, const StepInputs& inputs, const Positions& q, const Positions& y,
                           const Positions& x, Threads* threads, SurfaceWork& all, std::vector<Contact>& found) {
  if (inputs.meetings.empty()) return;
  Work& work = all.parts();
  move_surfaces(model, q, x, work);
  const std::size_t before = found.size();
  for (std::size_t m = 0; m < inputs.meetings.size(); ++m) {
    const Pair pair(model, inputs, inputs.meetings[m], q, y, x, work, work.beginnings[m]);
    const int chunks = static_cast<int>((pair.points() + points_a_chunk - 1) / points_a_chunk);
    if (std::ssize(work.by_chunk) < chunks) work.by_chunk.resize(chunks);
    run_chunks(threads, chunks, long(pair.points()) * 20, [&](int chunk) {
      work.by_chunk[chunk].clear();
      const std::size_t end = std::min(pair.points(), std::size_t(chunk + 1) * points_a_chunk);
      for (std::size_t i = std::size_t(chunk) * points_a_chunk; i < end; ++i) pair.find(i, work.by_chunk[chunk]);
    });
    for (int chunk = 0; chunk < chunks; ++chunk)
      found.insert(found.end(), work.by_chunk[chunk].begin(), work.by_chunk[chunk].end());
  }
  std::sort(found.begin() + static_cast<std::ptrdiff_t>(before), found.end(), comes_before);
}

void stop_at_surfaces(const Model& model, const StepInputs& inputs, const Positions& q, const Positions& x,
                      SurfaceWork& all, std::vector<double>& shares) {
  if (inputs.meetings.empty()) return;
  Work& work = all.parts();
  move_surfaces(model, q, x, work);
  for (std::size_t m = 0; m < inputs.meetings.size(); ++m) {
    const Meeting& meeting = inputs.meetings[m];
    const Pair pair(model, inputs, meeting, q, x, x, work, work.beginnings[m]);
    double least = std::max(shares[meeting.points], shares[meeting.surface]);
    for (std::size_t i = 0; i < pair.points(); ++i) least = std::min(least, pair.share_to_impact(i, least));
    shares[meeting.points] = std::min(shares[meeting.points], least);
    shares[meeting.surface] = std::min(shares[meeting.surface], least);
  }
}

}  // namespace supple
