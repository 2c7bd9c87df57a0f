#include "film/drawn_film.h"

#include <algorithm>
#include <utility>

namespace supple {

namespace {

std::vector<Camera> cameras_of(const Script& script, const Stage& stage) {
  std::vector<Camera> cameras = {make_camera(script.scene(), stage)};
  const auto moves_camera = [](const TimedChange* change) { return change->path.starts_with("camera."); };
  for (int frame = 0; frame < script.scene().frames; ++frame) {
    if (std::ranges::any_of(script.at_work(frame), moves_camera))
      cameras.push_back(make_camera(script.scene_at(frame), stage));
  }
  return cameras;
}

}  // namespace

DrawnFilm::DrawnFilm(const Script& script, const std::vector<Body>& bodies, std::vector<DrawnBody> drawn,
                     const CollisionSet& set, const std::string& font)
    : drawn_(std::move(drawn)) {
  const SceneDef& scene = script.scene();
  collider_skins_ = collider_skins(set.obstacles, bodies);
  // Cameras frame the bodies' boxes, which do not depend on the skins.
  const Stage fine = make_stage(scene, bodies, drawn_, set.obstacles, collider_skins_, font);
  fit_to_cameras(drawn_, bodies, cameras_of(script, fine), scene.output.height);
  stage_ = make_stage(scene, bodies, drawn_, set.obstacles, collider_skins_, font);
}

void DrawnFilm::renew(std::size_t collider, const CollisionSet& set, const std::vector<Body>& bodies) {
  collider_skins_[collider] = drawn_obstacle(set.obstacles[collider], bounds_at_rest(bodies));
  renewed_.push_back(collider);
}

DrawList DrawnFilm::list(const SceneDef& scene, const std::vector<std::unique_ptr<FilmedBody>>& bodies,
                         const CollisionSet& set, double time, Threads& threads) {
  DrawList result;
  result.camera = make_camera(scene, stage_);
  for (std::size_t b = 0; b < bodies.size(); ++b)
    result.positions.push_back(skin_positions(drawn_[b], bodies[b]->model(), bodies[b]->state(), &threads));
  add_colliders(set.obstacles, collider_skins_, time, result);
  for (const std::size_t c : std::exchange(renewed_, {}))
    result.renewed.emplace_back(bodies.size() + c, collider_mesh(set.obstacles[c], collider_skins_[c]));
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (stage_.meshes[b].label == scene.bodies[b].label) continue;
    stage_.meshes[b].label = scene.bodies[b].label;
    result.captions.emplace_back(b, scene.bodies[b].label);
  }
  return result;
}

}  // namespace supple
