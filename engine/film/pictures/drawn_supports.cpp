#include "film/pictures/drawn_supports.h"

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
    supports_.push_back(supports_of(body));
    for (const Support& one : supports_.back()) stage.meshes.push_back(mesh_of(one.surface));
  }
}

void DrawnSupports::add_to(DrawList& list, const SceneDef& scene, const FramePose& pose) const {
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const std::vector<HandleDef>& handles = scene.bodies[b].handles;
    for (const Support& one : supports_[b]) {
      const Eigen::Isometry3d motion = motion_of_held(bodies_[b], one.handle, *pose.motion[b]);
      const bool holds = handles[one.handle].holds_at(pose.time);
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
