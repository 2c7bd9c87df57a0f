#include "film/pictures/drawn_supports.h"

#include <utility>

#include "scene/definition/scene_def.h"

namespace supple {
namespace {

const Vec3 color(0.34, 0.35, 0.37);  // dark on all grounds, and without a hue of its own
constexpr double gloss = 0.3;

DrawMesh mesh_of(const TriMesh& surface) {
  DrawMesh mesh;
  mesh.triangles.assign(surface.triangles.data(), surface.triangles.data() + surface.triangles.size());
  mesh.occlusion.assign(std::size_t(surface.points.rows()), 1);
  mesh.paint.resize(std::size_t(surface.points.rows()));
  mesh.color = color;
  mesh.gloss = gloss;
  mesh.rest = bounds_of(surface.points);
  mesh.framed = false;  // so that cameras and lights are the same without supports
  return mesh;
}

}  // namespace

DrawnSupports::DrawnSupports(const std::vector<Body>& bodies, Stage& stage) : bodies_(bodies) {
  for (const Body& body : bodies) {
    std::vector<Drawn>& drawn = supports_.emplace_back();
    for (Support& one : supports_of(body)) {
      stage.meshes.push_back(mesh_of(one.surface));
      stage.meshes.back().name = body.def.name + ".supports";  // no body's name has a dot
      std::vector<std::int32_t> held = body.description.handles[one.handle].vertices;
      drawn.push_back({std::move(one), std::move(held)});
    }
  }
}

void DrawnSupports::add_to(DrawList& list, const SceneDef& scene, const FramePose& pose) const {
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const std::vector<HandleDef>& handles = scene.bodies[b].handles;
    const std::vector<Handle>& now = bodies_[b].description.handles;
    for (const auto& [one, held] : supports_[b]) {
      // A handle that was added while the film runs is gone after the film went back to before it.
      const bool is_there = one.handle < handles.size() && now[one.handle].vertices == held;
      const Eigen::Isometry3d motion = is_there ? motion_of_held(bodies_[b], one.handle, *pose.motion[b])
                                                : Eigen::Isometry3d(Eigen::Isometry3d::Identity());
      const bool holds = is_there && handles[one.handle].holds_at(pose.time);
      std::vector<float> points;
      for (Eigen::Index v = 0; v < one.surface.points.rows(); ++v) {
        // A mesh of a single point covers nothing.
        const Vec3 place = motion * Vec3(one.surface.points.row(holds ? v : 0));
        for (int k = 0; k < 3; ++k) points.push_back(static_cast<float>(place[k]));
      }
      list.positions.push_back(std::move(points));
    }
  }
}

}  // namespace supple
