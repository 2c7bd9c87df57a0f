#include "scene/overlaps.h"

#include <fmt/core.h>

#include <algorithm>

#include "scene/obstacle.h"
#include "sim/contact/way_out.h"

namespace supple {
namespace {

constexpr double tolerated = 1e-4;  // depth that is none, over the body's size
constexpr double small_move = 0.1;  // a move that nobody minds, over the body's size

bool lies_in(const Bounds& box, const Vec3& point) {
  return (point.array() >= box.lower.array()).all() && (point.array() <= box.upper.array()).all();
}

// Finds how deep the points lie in the colliders themselves; the layers around them may hold points at the start.
std::vector<Body::Overlap> overlaps_of(const CollisionSet& set, const Obstacles& obstacles, const Positions& points,
                                       double least) {
  std::vector<Body::Overlap> overlaps;
  for (std::size_t c = 0; c < obstacles.size(); ++c) {
    const Bounds box = set.colliders[c].shape.bounds();
    const Eigen::Isometry3d to_local = obstacles.poses()[c].inverse();
    double depth = 0;
    for (Eigen::Index v = 0; v < points.rows(); ++v) {
      const Vec3 point = points.row(v);
      if (lies_in(box, to_local * point))
        depth = std::max(depth, -obstacles.distance(c, point) - set.colliders[c].thickness);
    }
    if (depth > least) overlaps.push_back({set.colliders[c].name, depth});
  }
  return overlaps;
}

bool is_held(const Body& body) {
  return std::any_of(body.description.handles.begin(), body.description.handles.end(),
                     [](const Handle& handle) { return handle.holds; });
}

std::string vector_text(const Vec3& v) { return fmt::format("({:.3g}, {:.3g}, {:.3g})", v.x(), v.y(), v.z()); }

}  // namespace

void find_overlaps(const SceneDef& scene, std::vector<Body>& bodies, std::vector<Problem>& problems) {
  if (scene.colliders.empty()) return;
  const CollisionSet set = collision_set(scene);
  std::vector<Eigen::Isometry3d> poses;
  for (const Obstacle& obstacle : set.obstacles) poses.push_back(obstacle.pose(0));
  const Obstacles obstacles(set.colliders, poses);
  for (Body& body : bodies) {
    const Positions& rest = body.description.mesh.rest;
    const double size = bounds_of(rest).diagonal();
    const Positions points = start_positions(body.def.start, rest, body.seed, body.description.name);
    body.overlaps = overlaps_of(set, obstacles, points, tolerated * size);
    if (body.overlaps.empty()) continue;
    if (body.def.start_inside == StartInside::error) {
      problems.push_back({body.def.place.source, body.def.place.line, body.def.place.column, overlap_text(body)});
    } else if (body.def.start_inside == StartInside::move && !is_held(body)) {
      const std::optional<WayOut> way = way_out(obstacles, points, 0, small_move * size);
      if (way) body.start_move = way->distance * way->direction;
    }
  }
}

std::string overlap_text(const Body& body) {
  if (body.overlaps.empty()) return "";
  const double size = bounds_of(body.description.mesh.rest).diagonal();
  std::string places;
  for (const Body::Overlap& overlap : body.overlaps) {
    places += fmt::format("{}{:.3g} m deep inside collider '{}' ({:.2g} % of its size)", places.empty() ? "" : ", and ",
                          overlap.depth, overlap.collider, 100 * overlap.depth / size);
  }
  const std::string start = fmt::format("body '{}' starts {}: ", body.def.name, places);
  if (body.def.start_inside == StartInside::error) return start + "start_inside = \"error\" refuses that";
  if (!body.start_move.isZero(0))
    return start + fmt::format("it is moved out by {} m before the first frame", vector_text(body.start_move));
  const char* why = body.def.start_inside == StartInside::push ? "start_inside = \"push\""
                    : is_held(body)                            ? "handles hold it in its place"
                                                               : "no small move leads out";
  return start + fmt::format("{}, so it is pushed out while the film runs", why);
}

}  // namespace supple
