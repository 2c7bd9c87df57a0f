#include "scene/building/collision_set.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/shapes/solid_motion.h"
#include "geometry/skins/skin.h"
#include "geometry/solids/triangle_solid.h"
#include "scene/definition/rotation.h"
#include "scene/definition/scene_def.h"

namespace supple {
namespace {

// Returns the primitive of this kind of which the collider consists; null when the collider consists of another kind,
// or of more than one primitive.
template <class Kind>
const Kind* lone(const SceneCollider& collider) {
  const std::vector<ShapePart>& parts = collider.def.shape.root.parts;
  return parts.size() == 1 && !parts.front().mirror_x ? std::get_if<Kind>(&parts.front().primitive) : nullptr;
}

// Returns the surface of a collider that deforms, which is all of its shape.
ClosedSurface& surface_of_shape(Shape& shape) { return std::get<ClosedSurface>(shape.root.parts.front().primitive); }

Positions in_frame_of_shape(const ShapePart& part, Positions points) {
  const Eigen::Affine3d to_parent = Eigen::Affine3d(part.to_local.inverse()) * Eigen::Scaling(part.scale);
  for (Eigen::Index v = 0; v < points.rows(); ++v) points.row(v) = (to_parent * Vec3(points.row(v))).transpose();
  return points;
}

// Returns the plane of a half space in the collider's frame: its unit normal, and a point on it.
std::pair<Vec3, Vec3> plane_of(const SceneCollider& collider, const HalfSpace& half) {
  const ShapePart& part = collider.def.shape.root.parts.front();
  const Eigen::Isometry3d to_parent = part.to_local.inverse();
  return {to_parent.linear() * half.normal, to_parent * Vec3(part.scale * half.offset * half.normal)};
}

Skin square_of(const Vec3& normal, const Vec3& center, double half_edge) {
  constexpr int cells = 8;  // so that occlusion, which is stored by vertex, has vertices
  const Vec3 side = normal.cross(std::abs(normal.z()) < 0.9 ? Vec3::UnitZ() : Vec3::UnitX()).normalized();
  const Vec3 up = normal.cross(side);
  Skin skin;
  skin.rest.points.resize((cells + 1) * (cells + 1), 3);
  skin.rest.triangles.resize(2 * cells * cells, 3);
  for (int j = 0; j <= cells; ++j) {
    for (int i = 0; i <= cells; ++i) {
      const double s = 2.0 * i / cells - 1, t = 2.0 * j / cells - 1;
      skin.rest.points.row(j * (cells + 1) + i) = (center + half_edge * (s * side + t * up)).transpose();
    }
  }
  int row = 0;
  for (int j = 0; j < cells; ++j) {
    for (int i = 0; i < cells; ++i) {
      const int a = j * (cells + 1) + i, b = a + 1, c = a + cells + 1, d = c + 1;
      skin.rest.triangles.row(row++) << a, b, d;
      skin.rest.triangles.row(row++) << a, d, c;
    }
  }
  skin.occlusion.assign(skin.rest.points.rows(), 1.0f);
  skin.paint.resize(skin.rest.points.rows());
  return skin;
}

}  // namespace

Eigen::Isometry3d SceneCollider::pose(double time) const { return motion.at(time) * rest; }

double SceneCollider::frame(double time) const {
  const SurfaceMotionDef& by = *def.motion;
  const double gone = std::max(0.0, time - by.start) * by.fps.value_or(scene_fps);
  return std::min(by.first + gone, double(by.motion->frames() - 1));
}

Shape SceneCollider::shape_at(double time) const {
  Shape shape = def.shape;
  if (def.motion) surface_of_shape(shape) = {def.motion->motion->solid_at(frame(time))};
  return shape;
}

CollisionSet collision_set(const SceneDef& scene) {
  CollisionSet set;
  for (const ColliderDef& def : scene.colliders) {
    SceneCollider collider;
    collider.def = def;
    collider.motion = {def.position, def.ease, def.keys};
    collider.rest.translate(def.position).rotate(rotation_from_degrees(def.turn_deg));
    collider.scene_fps = scene.fps;
    if (def.motion) {
      collider.def.shape = collider.shape_at(0);
      set.deformed.resize(scene.colliders.size());
    }
    set.colliders.push_back({def.name, collider.def.shape, def.thickness, def.friction});
    set.scene_colliders.push_back(std::move(collider));
  }
  return set;
}

void deform_colliders(CollisionSet& set, double from, double to) {
  for (std::size_t c = 0; c < set.deformed.size(); ++c) {
    const SceneCollider& collider = set.scene_colliders[c];
    if (!collider.def.motion) continue;
    DeformedStep& step = set.deformed[c];
    const double first = collider.frame(from), last = collider.frame(to);
    if (step.end && step.from == first && step.to == last) continue;
    const SolidMotion& motion = *collider.def.motion->motion;
    DeformedStep next{first, last, step.end && step.to == first ? step.end : motion.solid_at(first), nullptr, nullptr};
    next.end = first == last ? next.start : motion.solid_at(last);
    // A contact lies in the layer around the collider, or little deeper than its surface.
    constexpr double near = 0.05;  // over the surface's size
    const double scale = collider.def.shape.root.parts.front().scale;
    const double reach = near * next.end->bounds().diagonal() + 2 * collider.def.thickness / scale;
    next.move = std::make_shared<SurfaceMove>(next.start, next.end, reach);
    step = std::move(next);
    surface_of_shape(set.colliders[c].shape) = {step.end};
  }
}

namespace {

Eigen::Isometry3d between(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b, double share) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translate((1 - share) * a.translation() + share * b.translation());
  return pose.rotate(Eigen::Quaterniond(a.linear()).slerp(share, Eigen::Quaterniond(b.linear())));
}

}  // namespace

void collider_motions(const CollisionSet& set, const StepSpan& span, std::vector<ColliderMotion>& motions) {
  motions.clear();
  for (std::size_t c = 0; c < set.scene_colliders.size(); ++c) {
    const auto pose = [&](double time, double change) {
      const Eigen::Isometry3d now = set.scene_colliders[c].pose(time);
      return set.earlier.empty() || change >= 1 ? now : between(set.earlier[c].pose(time), now, change);
    };
    motions.push_back({pose(span.from, span.change_from), pose(span.to, span.change_to),
                       set.deformed.empty() ? nullptr : set.deformed[c].move});
  }
}

bool is_half_space(const SceneCollider& collider) { return lone<HalfSpace>(collider) != nullptr; }

bool is_ground(const SceneCollider& collider) {
  const HalfSpace* half = lone<HalfSpace>(collider);
  if (half == nullptr || !collider.def.keys.empty()) return false;
  const auto [normal, point] = plane_of(collider, *half);
  return (collider.rest.linear() * normal).isApprox(Vec3::UnitY(), 1e-9) &&
         std::abs((collider.rest * point).y()) < 1e-9;
}

Skin drawn_collider(const SceneCollider& collider, const Bounds& around) {
  if (!collider.def.visible || is_ground(collider)) return {};
  if (const HalfSpace* half = lone<HalfSpace>(collider)) {
    const auto [normal, point] = plane_of(collider, *half);
    const Vec3 middle = collider.rest.inverse() * around.center();
    return square_of(normal, middle - (middle - point).dot(normal) * normal, 1.5 * around.diagonal());
  }
  const Shape& shape = collider.def.shape;
  std::vector<std::int32_t> vertex_of;
  if (const auto* surface = lone<ClosedSurface>(collider)) {
    const TriMesh& drawn = surface->drawn ? *surface->drawn : surface->solid->surface();
    const Positions points = in_frame_of_shape(shape.root.parts.front(), drawn.points);
    Skin skin = skin_of_surface(points, drawn.triangles, 0, vertex_of);
    if (collider.def.motion) skin.vertex_of = std::move(vertex_of);
    return skin;
  }
  constexpr double cells = 96;  // along the longest side
  const Skin skin = skin_of(shape, shape.bounds().extent().maxCoeff() / cells);
  // Vertices at creases occur once for each side, so that a box has sharp edges.
  Skin creased = skin_of_surface(skin.rest.points, skin.rest.triangles, 0, vertex_of);
  for (std::size_t v = 0; v < vertex_of.size(); ++v) {
    creased.occlusion[v] = skin.occlusion[vertex_of[v]];
    creased.paint[v] = skin.paint[vertex_of[v]];
  }
  return creased;
}

namespace {

// Returns the vertices of a surface that deforms, in the collider's frame.
Positions deformed_places(const SceneCollider& collider, double time) {
  return in_frame_of_shape(collider.def.shape.root.parts.front(),
                           collider.def.motion->motion->points_at(collider.frame(time)));
}

}  // namespace

Positions drawn_places(const SceneCollider& collider, const Skin& skin, double time) {
  if (skin.vertex_of.empty()) return skin.rest.points;
  return deformed_places(collider, time)(skin.vertex_of, Eigen::all);
}

Positions world_places(const SceneCollider& collider, double time) {
  const Eigen::Isometry3d pose = collider.pose(time);
  const Positions places = deformed_places(collider, time);
  return (places * pose.linear().transpose()).rowwise() + pose.translation().transpose();
}

}  // namespace supple
