#include "film/drawn_film.h"

#include <utility>

namespace supple {

DrawnFilm::DrawnFilm(const SceneDef& scene, const std::vector<Body>& bodies, const CollisionSet& set,
                     const std::string& font) {
  for (const Body& body : bodies) drawn_.push_back(drawn_body(scene, body));
  collider_skins_ = collider_skins(set.obstacles, bodies);
  stage_ = make_stage(scene, bodies, drawn_, set.obstacles, collider_skins_, font);
}

void DrawnFilm::renew(std::size_t collider, const CollisionSet& set, const std::vector<Body>& bodies) {
  collider_skins_[collider] = drawn_obstacle(set.obstacles[collider], bounds_at_rest(bodies));
  renewed_.push_back(collider);
}

DrawList DrawnFilm::list(const SceneDef& scene, const std::vector<std::unique_ptr<FilmedBody>>& bodies,
                         const CollisionSet& set, double time) {
  DrawList result;
  result.camera = make_camera(scene, stage_);
  for (std::size_t b = 0; b < bodies.size(); ++b)
    result.positions.push_back(skin_positions(drawn_[b], bodies[b]->model(), bodies[b]->state()));
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
