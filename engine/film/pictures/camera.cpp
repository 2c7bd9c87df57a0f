#include "film/pictures/camera.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/motion_hull.h"
#include "render/view.h"
#include "scene/definition/body_def.h"
#include "scene/definition/camera_def.h"
#include "scene/definition/collider_def.h"
#include "scene/definition/scene_def.h"

namespace supple {
namespace {

template <class T>
T between(const T& from, const T& to, double s) {
  return from + s * (to - from);
}

// Returns the value at a time of those keys that have it; `fallback` where none has.
template <class T>
T value_at(const CameraDef& camera, double time, std::optional<T> CameraKey::*member, const T& fallback) {
  const CameraKey *before = nullptr, *after = nullptr;
  for (const CameraKey& key : camera.keys) {
    if (!(key.*member)) continue;
    if (key.time <= time) before = &key;
    if (key.time > time && after == nullptr) after = &key;
  }
  if (before == nullptr && after == nullptr) return fallback;
  if (before == nullptr) return *(after->*member);
  if (after == nullptr) return *(before->*member);
  double s = (time - before->time) / (after->time - before->time);
  if (camera.ease == Ease::smooth) s = s * s * (3 - 2 * s);
  return between(*(before->*member), *(after->*member), s);
}

Vec3 mean_of(const std::vector<float>& points) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t i = 0; i + 2 < points.size(); i += 3) sum += Vec3(points[i], points[i + 1], points[i + 2]);
  return sum / std::max(1.0, static_cast<double>(points.size() / 3));
}

// Returns the number of the mesh of a body or collider: bodies come first, then colliders.
std::size_t mesh_called(const SceneDef& scene, const std::string& name) {
  std::size_t mesh = 0;
  for (const BodyDef& body : scene.bodies) {
    if (body.name == name) return mesh;
    ++mesh;
  }
  for (const ColliderDef& collider : scene.colliders) {
    if (collider.name == name) return mesh;
    ++mesh;
  }
  return mesh;
}

bool will_fall(const SceneDef& scene, const BodyDef& body) { return body.handles.empty() && scene.gravity.y() < 0; }

// Tells whether the camera shows the bodies' whole motion, which the stage knows.
bool frames_motion(const SceneDef& scene, const Stage& stage) {
  if (stage.motion.empty()) return false;
  const CameraDef& camera = scene.camera;
  return camera.frames == Framed::film || (camera.frames == Framed::automatic && !camera.is_placed());
}

// Returns the points that bound the bodies' whole motion, and what else is framed.
std::vector<Vec3> points_of_motion(const SceneDef& scene, const Stage& stage) {
  std::vector<Vec3> points = stage.motion;
  for (std::size_t m = scene.bodies.size(); m < stage.meshes.size(); ++m) {
    if (!stage.meshes[m].framed) continue;
    for (const Vec3& corner : corners_of(stage.meshes[m].rest)) points.push_back(corner);
  }
  return points;
}

// Returns the camera at a distance at which all that it frames is in the picture.
Camera framing_camera(const SceneDef& scene, const Stage& stage, const Vec3& direction, double fov) {
  const bool motion = frames_motion(scene, stage);
  // The outline of the whole motion is larger than the bodies are at any one time, so less air is enough.
  const double margin = motion && scene.camera.has_usual_margin ? CameraDef::margin_of_motion : scene.camera.margin;
  // The legend may stand in the air around the bodies. Only where the air is too narrow, the bodies become smaller.
  constexpr double least_air = 1.05;
  const double narrower = std::min(1.0, margin * (1 - 2 * stage.kept_free) / least_air);
  const double aspect = narrower * stage.width / stage.height;
  if (!motion) return framing(framed_box(scene, stage), direction, fov, margin, aspect);
  const std::vector<Vec3> points = points_of_motion(scene, stage);
  // A camera that goes round the bodies frames their box, because its distance from an outline would waver.
  if (scene.camera.moves()) return framing(box_around(points), direction, fov, margin, aspect);
  const bool captions = std::ranges::any_of(stage.meshes, [](const DrawMesh& mesh) { return !mesh.label.empty(); });
  constexpr double of_captions = 0.06;
  return framing(points, direction, fov, margin, aspect, captions ? of_captions : 0);
}

// Returns what the camera shows of the bodies to either side, as the tangent of half an angle, in a picture whose sides
// are at `most`; `most` itself where bodies or camera may move on.
double shown_to_the_sides(const SceneDef& scene, const Stage& stage, const Camera& camera, double most) {
  constexpr double air = 1.05;
  if (stage.motion.empty() || scene.camera.moves() || !scene.camera.follow.empty()) return most;
  const Eigen::Matrix4d to_eye = look_at(camera.eye, camera.target).cast<double>();
  double shown = 0;
  for (const Vec3& point : points_of_motion(scene, stage)) {
    const Vec3 at = to_eye.topLeftCorner<3, 3>() * (point - camera.eye);
    shown = at.z() < 0 ? std::max(shown, air * std::abs(at.x()) / -at.z()) : most;
  }
  return std::min(shown, most);
}

// Widens the view of a camera that the scene places, for pictures that are narrower than those for which it was placed:
// what these showed of the bodies stays in the picture.
void keep_sides(const SceneDef& scene, const Stage& stage, Camera& camera) {
  const double aspect = static_cast<double>(stage.width) / stage.height, before = scene.output.aspect;
  if (!is_at_fixed_distance(scene.camera) || before <= aspect) return;
  const double high = std::tan(camera.fov_deg * std::numbers::pi / 360);
  const double wide = shown_to_the_sides(scene, stage, camera, high * before);
  camera.fov_deg = 360 / std::numbers::pi * std::atan(std::max(high, wide / aspect));
}

}  // namespace

bool is_at_fixed_distance(const CameraDef& camera) {
  return camera.position || camera.distance ||
         std::ranges::any_of(camera.keys, [](const CameraKey& key) { return key.position || key.distance; });
}

bool wants_motion(const SceneDef& scene) {
  const bool narrower = scene.output.aspect > static_cast<double>(scene.output.width) / scene.output.height;
  return scene.camera.frames == Framed::film || (narrower && is_at_fixed_distance(scene.camera));
}

Bounds framed_box(const SceneDef& scene, const Stage& stage) {
  Bounds box;
  for (std::size_t m = 0; m < stage.meshes.size(); ++m) {
    const DrawMesh& mesh = stage.meshes[m];
    if (!mesh.framed) continue;
    box.include(mesh.rest.lower);
    box.include(mesh.rest.upper);
    const bool falls = m < scene.bodies.size() && will_fall(scene, scene.bodies[m]) && mesh.rest.lower.y() > 0;
    if (falls) box.include(Vec3(mesh.rest.lower.x(), 0, mesh.rest.lower.z()));  // the drawn ground is at y = 0
  }
  return box;
}

std::optional<Followed> followed_at(const SceneDef& scene, const Stage& stage,
                                    const std::vector<std::vector<float>>& positions) {
  if (scene.camera.follow.empty()) return std::nullopt;
  const std::size_t mesh = mesh_called(scene, scene.camera.follow);
  const bool known = mesh < positions.size() && !positions[mesh].empty();
  return Followed{mesh, known ? Vec3(mean_of(positions[mesh]) - stage.meshes[mesh].rest.center()) : Vec3(Vec3::Zero())};
}

Camera camera_at(const SceneDef& scene, const Stage& stage, double time,
                 const std::vector<std::vector<float>>& positions) {
  const CameraDef& def = scene.camera;
  const double degree = std::numbers::pi / 180;
  const double azimuth =
      degree * (value_at(def, time, &CameraKey::azimuth_deg, def.azimuth_deg) + def.orbit_deg * time);
  const double elevation = degree * value_at(def, time, &CameraKey::elevation_deg, def.elevation_deg);
  const double fov = value_at(def, time, &CameraKey::fov_deg, def.fov_deg);
  const Vec3 direction(std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
                       std::cos(azimuth) * std::cos(elevation));
  Camera camera = framing_camera(scene, stage, direction, fov);
  const double distance = (camera.eye - camera.target).norm();
  camera.target = value_at<Vec3>(def, time, &CameraKey::target, def.target.value_or(camera.target));
  camera.eye = camera.target + value_at(def, time, &CameraKey::distance, def.distance.value_or(distance)) * direction;
  camera.eye = value_at<Vec3>(def, time, &CameraKey::position, def.position.value_or(camera.eye));
  keep_sides(scene, stage, camera);
  const std::optional<Followed> followed = followed_at(scene, stage, positions);
  if (!followed) return camera;
  const Vec3 center = stage.meshes[followed->mesh].rest.center() + followed->moved;
  // A given position keeps the place that it has relative to the followed object at rest.
  camera.eye = center + (camera.eye - camera.target);
  if (def.position) camera.eye = *def.position + followed->moved;
  camera.target = center;
  return camera;
}

double focus_at(const SceneDef& scene, const Camera& camera, const std::vector<std::vector<float>>& positions) {
  if (scene.camera.focus_distance) return *scene.camera.focus_distance;
  const double to_target = (camera.target - camera.eye).norm();
  if (scene.camera.focus_on.empty()) return to_target;
  const std::size_t mesh = mesh_called(scene, scene.camera.focus_on);
  if (mesh >= positions.size() || positions[mesh].empty()) return to_target;
  const double distance = (mean_of(positions[mesh]) - camera.eye).dot(camera.target - camera.eye) / to_target;
  return distance > 1e-3 * to_target ? distance : to_target;
}

double share_in_picture(const Camera& camera, const Stage& stage, const std::vector<float>& points) {
  constexpr std::size_t enough = 2000;  // points are enough for the share
  const Eigen::Matrix4d to_eye = look_at(camera.eye, camera.target).cast<double>();
  const double high = std::tan(camera.fov_deg * std::numbers::pi / 360), wide = high * stage.width / stage.height;
  const std::size_t step = std::max<std::size_t>(1, points.size() / 3 / enough);
  int seen = 0, all = 0;
  for (std::size_t i = 0; i + 2 < points.size(); i += 3 * step) {
    const Vec3 from = Vec3(points[i], points[i + 1], points[i + 2]) - camera.eye;
    const Vec3 at = to_eye.topLeftCorner<3, 3>() * from;  // to the right, up, and towards the eye
    ++all;
    seen += at.z() < 0 && std::abs(at.x()) <= -wide * at.z() && std::abs(at.y()) <= -high * at.z() ? 1 : 0;
  }
  return all > 0 ? double(seen) / all : 1;
}

}  // namespace supple
