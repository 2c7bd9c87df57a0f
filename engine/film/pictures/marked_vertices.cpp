#include "film/pictures/marked_vertices.h"

#include <algorithm>
#include <optional>

#include "geometry/shapes/shape_probe.h"

namespace supple {

std::vector<double> depths_in(const Positions& x, const CollisionSet& set, double time, double reach,
                              Threads* threads) {
  std::vector<double> deepest(x.rows(), -reach);
  constexpr Eigen::Index chunk = 512;
  for (std::size_t c = 0; c < set.scene_colliders.size(); ++c) {
    const Collider& collider = set.colliders[c];
    const Eigen::Isometry3d to_local = set.scene_colliders[c].pose(time).inverse();
    const SceneCollider& from_scene = set.scene_colliders[c];
    const std::optional<Shape> deformed =
        from_scene.def.motion ? std::optional(from_scene.shape_at(time)) : std::nullopt;
    const ShapeProbe probe(deformed ? *deformed : collider.shape);
    run_chunks(threads, static_cast<int>((x.rows() + chunk - 1) / chunk), 200 * x.rows(), [&](int number) {
      QueryMemory near;
      for (Eigen::Index v = number * chunk; v < std::min(x.rows(), (number + 1) * chunk); ++v) {
        const Vec3 p = to_local * Vec3(x.row(v));
        if (probe.distance(p, near) > collider.thickness + reach) continue;
        deepest[v] = std::max(deepest[v], collider.thickness - probe.closest(p, near).distance);
      }
    });
  }
  return deepest;
}

void append_marks(const Body& body, const Positions& motion, const CollisionSet& set, double time, Threads* threads,
                  std::vector<std::array<float, 4>>& marks) {
  const auto add = [&](Eigen::Index v, float kind) {
    marks.push_back(
        {static_cast<float>(motion(v, 0)), static_cast<float>(motion(v, 1)), static_cast<float>(motion(v, 2)), kind});
  };
  for (std::size_t h = 0; h < body.description.handles.size(); ++h) {
    if (!body.def.handles[h].holds_at(time)) continue;
    for (const std::int32_t v : body.description.handles[h].vertices) add(v, 0);
  }
  const double near = 1e-3 * bounds_of(body.description.mesh.rest).diagonal();
  const std::vector<double> depth = depths_in(motion, set, time, near, threads);
  for (std::size_t v = 0; v < depth.size(); ++v) {
    if (depth[v] > -near) add(static_cast<Eigen::Index>(v), 1);
  }
}

}  // namespace supple
