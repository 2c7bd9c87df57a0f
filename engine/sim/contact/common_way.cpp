#include "sim/contact/common_way.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/contact/solid_pair.h"

namespace supple {
namespace {

using Work = SurfaceWork::Parts;

constexpr double deep = 0.02;           // over the size of the smaller part
constexpr std::size_t deep_share = 8;   // one of so many points that are asked must begin the step so deep
constexpr double most_favoured = 0.25;  // over the size of the smaller part
constexpr double one_way = 0.99;        // cosine of directions of which one is enough

// Holds the points of one part that begin the step inside the other.
struct Inside {
  struct Point {
    Vec3 at;
    MovingSurface::Place closest;
  };
  const MovingSurface* surface;  // the surface of the other part
  std::vector<Point> points;
  std::size_t asked = 0;

  bool is_deep(double depth) const {
    const auto deeper = std::ranges::count_if(points, [&](const Point& p) { return p.closest.distance < -depth; });
    return deeper > 0 && deep_share * static_cast<std::size_t>(deeper) >= asked;
  }
};

Inside points_inside(const SolidPair& pair, const std::vector<std::int32_t>& vertices, const Positions& q,
                     const MovingSurface& surface) {
  Inside inside{&surface, {}};
  for (std::size_t i = 0; i < pair.points(); ++i) {
    inside.asked += pair.is_looked_at(i);
    if (const MovingSurface::Place* place = pair.beginning_inside(i))
      inside.points.push_back({q.row(vertices[i]).transpose(), *place});
  }
  return inside;
}

// Adds the normals of the triangles that are closest to points inside, each times a sign.
void add_normals(const Inside& inside, double sign, std::vector<Vec3>& directions) {
  const Positions& x = inside.surface->start();
  for (const Inside::Point& point : inside.points) {
    const auto corners = inside.surface->triangles().row(point.closest.triangle);
    const Vec3 first = x.row(corners[0]).transpose();
    const Vec3 normal = (x.row(corners[1]).transpose() - first).cross(x.row(corners[2]).transpose() - first);
    if (!(normal.norm() > 0)) continue;
    const Vec3 direction = sign * normal.normalized();
    if (std::ranges::none_of(directions, [&](const Vec3& known) { return known.dot(direction) > one_way; }))
      directions.push_back(direction);
  }
}

// Returns how far the points inside must go along a direction until each of them is out [m].
double way_out(const Inside& inside, const Vec3& direction) {
  const Bounds& box = inside.surface->bounds_at_start();
  const double through = (box.upper - box.lower).norm();
  double furthest = 0;
  for (const Inside::Point& point : inside.points) {
    const auto exit = inside.surface->last_exit_at_start(point.at, point.at + through * direction);
    if (exit) furthest = std::max(furthest, exit->share * through);
  }
  return furthest;
}

}  // namespace

// Tries the normals of the places that are closest to points inside, and takes the one along which the parts have to go
// least far. A way on which they already move counts as shorter: they would otherwise be pushed to and fro between ways
// that are about equally long.
void find_common_way(const Model& model, const StepInputs& inputs, std::size_t meeting, const Positions& q,
                     const Positions& y, const Positions& x, Work& work) {
  if (work.common_ways[meeting].is_known) return;
  const Meeting& of = inputs.meetings[meeting];
  const auto points = static_cast<std::size_t>(of.points), surface = static_cast<std::size_t>(of.surface);
  const auto exchanged = std::ranges::find_if(
      inputs.meetings, [&](const Meeting& other) { return other.points == of.surface && other.surface == of.points; });
  std::vector<std::size_t> meetings = {meeting};
  if (model.parts[points].solid && exchanged != inputs.meetings.end())
    meetings.push_back(static_cast<std::size_t>(exchanged - inputs.meetings.begin()));
  std::vector<Inside> sides;
  for (const std::size_t m : meetings) {
    work.common_ways[m] = {.is_known = true};
    const auto own = static_cast<std::size_t>(inputs.meetings[m].points);
    sides.push_back(points_inside(SolidPair(model, inputs, m, q, y, x, work), work.surfaces[own].points, q,
                                  *work.surfaces[static_cast<std::size_t>(inputs.meetings[m].surface)].moving));
  }
  const double size = std::min(model.parts[points].size, model.parts[surface].size);
  if (std::ranges::none_of(sides, [&](const Inside& side) { return side.is_deep(deep * size); })) return;

  const Vec3 velocity =
      (work.surfaces[points].carried_freely - work.surfaces[surface].carried_freely) / model.time_step;
  std::vector<Vec3> directions;  // in which the meeting's points leave
  add_normals(sides.front(), 1, directions);
  if (sides.size() > 1) add_normals(sides.back(), -1, directions);
  Work::CommonWay best{.is_known = true};
  double least = std::numeric_limits<double>::infinity();
  for (const Vec3& direction : directions) {
    double length = way_out(sides.front(), direction);
    if (sides.size() > 1) length = std::max(length, way_out(sides.back(), -direction));
    const double moves = velocity.dot(direction) / inputs.solver.contact.push_out;
    const double counts = length - std::clamp(moves, -most_favoured * size, most_favoured * size);
    if (!(counts < least)) continue;
    least = counts;
    best.direction = direction;
    best.length = (1 + 1e-6) * length;  // the furthest point must not miss its exit by round-off
  }
  work.common_ways[meetings.front()] = best;
  best.direction *= -1;
  if (meetings.size() > 1) work.common_ways[meetings.back()] = best;
}

}  // namespace supple
