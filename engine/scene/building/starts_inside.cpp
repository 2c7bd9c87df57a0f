#include "scene/building/starts_inside.h"

#include <fmt/core.h>

#include <algorithm>

#include "scene/building/collision_set.h"
#include "scene/definition/scene_def.h"
#include "sim/contact/usual_depth.h"
#include "sim/contact/way_out.h"
#include "sim/measures/measures.h"

namespace supple {
namespace {

constexpr double small_move = 0.1;  // the largest move that is still small, over the body's size

bool lies_in(const Bounds& box, const Vec3& point) {
  return (point.array() >= box.lower.array()).all() && (point.array() <= box.upper.array()).all();
}

// Finds how deep the points, of which the first ones are vertices, lie in the colliders themselves; the layers around
// them may hold points at the start.
std::vector<Body::InsideCollider> starts_inside_of(const CollisionSet& set, const Obstacles& obstacles,
                                                   const Positions& points, Eigen::Index vertices, double least) {
  std::vector<Body::InsideCollider> starts_inside;
  for (std::size_t c = 0; c < obstacles.size(); ++c) {
    const Bounds box = set.colliders[c].shape.bounds();
    const Eigen::Isometry3d to_local = obstacles.poses()[c].inverse();
    double depth = 0, of_vertices = 0;
    for (Eigen::Index v = 0; v < points.rows(); ++v) {
      const Vec3 point = points.row(v);
      if (lies_in(box, to_local * point))
        depth = std::max(depth, -obstacles.distance(c, point) - set.colliders[c].thickness);
      if (v < vertices) of_vertices = depth;
    }
    if (depth > least) starts_inside.push_back({set.colliders[c].name, depth, of_vertices <= least});
  }
  return starts_inside;
}

// Tells whether a box in a pose may meet another box, by the balls around both.
bool may_meet(const Bounds& box, const Eigen::Isometry3d& pose, const Bounds& other) {
  return (pose * box.center() - other.center()).norm() <= 0.5 * (box.diagonal() + other.diagonal());
}

// Finds the places between the vertices of a body's surface that lie in colliders, so deep that contact of points
// between vertices would find them.
std::vector<Vec3> places_between(const CollisionSet& set, const Obstacles& obstacles, const Body& body,
                                 const Positions& vertices) {
  const Triangles surface = surface_of(body);
  const Bounds around = bounds_of(vertices);
  const double size = bounds_of(body.description.mesh.rest).diagonal();
  std::vector<Vec3> places;
  for (std::size_t c = 0; c < obstacles.size(); ++c) {
    if (is_half_space(set.scene_colliders[c]) ||
        !may_meet(set.colliders[c].shape.bounds(), obstacles.poses()[c], around))
      continue;
    const Collider& collider = set.colliders[c];
    const double depth = usual_depth(size, collider, collider.shape.half_thickness());
    const std::vector<Vec3> more = deep_places(collider, obstacles.poses()[c], vertices, surface, depth);
    places.insert(places.end(), more.begin(), more.end());
  }
  return places;
}

void append(Positions& points, const std::vector<Vec3>& places) {
  const Eigen::Index before = points.rows();
  points.conservativeResize(before + Eigen::Index(places.size()), 3);
  for (std::size_t i = 0; i < places.size(); ++i) points.row(before + Eigen::Index(i)) = places[i];
}

// Finds a small move that brings a body out of the colliders, also between its vertices: places that are inside after a
// move count with the others in the next attempt. Returns nothing where several attempts have found no such move.
std::optional<Vec3> small_way_out(const CollisionSet& set, const Obstacles& obstacles, const Body& body,
                                  const Positions& vertices, Positions points, double furthest) {
  constexpr int attempts = 8;
  for (int attempt = 0; attempt < attempts; ++attempt) {
    const std::optional<WayOut> way = way_out(obstacles, points, 0, furthest);
    if (!way) return std::nullopt;
    const Vec3 move = way->distance * way->direction;
    const Positions moved = vertices.rowwise() + move.transpose();
    std::vector<Vec3> inside = places_between(set, obstacles, body, moved);
    if (inside.empty()) return move;
    for (Vec3& place : inside) place -= move;
    append(points, inside);
  }
  return std::nullopt;
}

bool is_held(const Body& body) {
  return std::any_of(body.description.handles.begin(), body.description.handles.end(),
                     [](const Handle& handle) { return handle.holds; });
}

std::string vector_text(const Vec3& v) { return fmt::format("({:.3g}, {:.3g}, {:.3g})", v.x(), v.y(), v.z()); }

}  // namespace

void find_starts_inside(const SceneDef& scene, std::vector<Body>& bodies, std::vector<Problem>& problems) {
  if (scene.colliders.empty()) return;
  const CollisionSet set = collision_set(scene);
  std::vector<Eigen::Isometry3d> poses;
  for (const SceneCollider& collider : set.scene_colliders) poses.push_back(collider.pose(0));
  const Obstacles obstacles(set.colliders, poses);
  for (Body& body : bodies) {
    const Positions& rest = body.description.mesh.rest;
    const double size = bounds_of(rest).diagonal();
    const Positions vertices = start_positions(body.def.start, rest, body.seed, body.description.name);
    Positions points = vertices;
    append(points, places_between(set, obstacles, body, vertices));
    body.starts_inside = starts_inside_of(set, obstacles, points, vertices.rows(), tolerated_overlap * size);
    if (body.starts_inside.empty()) continue;
    if (body.def.start_inside == StartInside::error) {
      problems.push_back({body.def.place, start_inside_text(body)});
    } else if (body.def.start_inside == StartInside::move && !is_held(body)) {
      const std::optional<Vec3> move = small_way_out(set, obstacles, body, vertices, points, small_move * size);
      if (move) body.start_move = *move;
    }
  }
}

namespace {

// Tells what becomes of a body that is not moved.
std::string way_of_pushing(const Body& body) {
  const bool unseen =
      body.def.solver.settings.contact.points == ContactPoints::vertices &&
      std::ranges::all_of(body.starts_inside, [](const Body::InsideCollider& one) { return one.between; });
  if (unseen)
    return "contact of vertices alone does not see that, and leaves it there; solver.contact.points = \"surface\" does";
  const char* why = body.def.start_inside == StartInside::push ? "start_inside = \"push\""
                    : is_held(body)                            ? "handles hold it in its place"
                                                               : "no small move leads out";
  return fmt::format("{}, so it is pushed out while the film runs", why);
}

}  // namespace

std::string start_inside_text(const Body& body) {
  if (body.starts_inside.empty()) return "";
  const double size = bounds_of(body.description.mesh.rest).diagonal();
  std::string places;
  for (const Body::InsideCollider& inside : body.starts_inside) {
    places += fmt::format("{}{:.3g} m deep inside collider '{}' ({:.2g} % of its size{})",
                          places.empty() ? "" : ", and ", inside.depth, inside.collider, 100 * inside.depth / size,
                          inside.between ? ", between its vertices" : "");
  }
  const std::string start = fmt::format("body '{}' starts {}: ", body.def.name, places);
  if (body.def.start_inside == StartInside::error) return start + "start_inside = \"error\" refuses that";
  if (!body.start_move.isZero(0))
    return start + fmt::format("it is moved out by {} m before the first frame", vector_text(body.start_move));
  return start + way_of_pushing(body);
}

}  // namespace supple
