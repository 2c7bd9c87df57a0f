#include "film/pictures/drawn_film.h"

#include <algorithm>
#include <utility>

#include "film/pictures/camera.h"
#include "film/pictures/drawn_cloth.h"
#include "film/pictures/film_graphs.h"
#include "film/pictures/marked_vertices.h"
#include "film/pictures/picture_words.h"
#include "render/legend.h"

namespace supple {

namespace {

bool changes_camera(const Script& script, int frame) {
  return std::ranges::any_of(script.at_work(frame),
                             [](const TimedChange* change) { return change->path.starts_with("camera"); });
}

bool changes_shutter(const TimedChange& change) {
  return change.path == "camera" || change.path.starts_with("camera.shutter");
}

// Tells whether what moves is blurred in some frame of the film.
bool opens_shutter(const Script& script) {
  return script.scene().camera.shutter_deg > 0 || std::ranges::any_of(script.changes(), changes_shutter);
}

// Tells whether the camera moves in the film, of itself or because a replay moves it.
bool moves_camera(const Script& script) {
  const SceneDef& scene = script.scene();
  if (scene.camera.moves() || !scene.camera.follow.empty()) return true;
  for (int frame = 0; frame < scene.frames; ++frame) {
    if (changes_camera(script, frame)) return true;
  }
  return false;
}

std::vector<Camera> cameras_of(const Script& script, const Stage& stage) {
  SceneDef scene = script.scene();
  std::vector<Camera> cameras = {camera_at(scene, stage, 0)};
  for (int frame = 0; frame < script.scene().frames; ++frame) {
    const bool changes = changes_camera(script, frame);
    if (changes) scene = script.scene_at(frame);
    if (changes || scene.camera.moves()) cameras.push_back(camera_at(scene, stage, scene.time_after(frame)));
  }
  return cameras;
}

}  // namespace

DrawnFilm::DrawnFilm(const Script& script, const std::vector<Body>& bodies, std::vector<DrawnBody> drawn,
                     const CollisionSet& set, const Font& font)
    : bodies_(bodies), start_(script.scene()), drawn_(std::move(drawn)) {
  const SceneDef& scene = start_;
  collider_skins_ = collider_skins(set.scene_colliders, bodies);
  // Cameras frame the bodies' boxes, which do not depend on the skins.
  const Stage fine = make_stage(scene, bodies, drawn_, set.scene_colliders, collider_skins_, font);
  cameras_ = cameras_of(script, fine);
  fit_to_cameras(drawn_, bodies, cameras_, scene.output.height);
  for (std::size_t c = 0; c < collider_skins_.size(); ++c)
    round_for_cameras(collider_skins_[c], set.scene_colliders[c], cameras_, scene.output.height);
  stage_ = make_stage(scene, bodies, drawn_, set.scene_colliders, collider_skins_, font);
  stage_.graphs = graph_looks(scene, 0);
  stage_.camera_moves = moves_camera(script);
  opens_ = opens_shutter(script);
  if (scene.look.supports) supports_.emplace(bodies, stage_);
  if (!scene.look.ghost.empty()) add_ghosts(scene, bodies);
  if (scene.field.quantity != FieldQuantity::none) field_.emplace(scene, bodies);
  for (std::size_t b = 0; b < bodies.size() && field_; ++b) stage_.meshes[b].mapped = field_->shown_on(b);
  show_field();
}

// Gives the stage the colours and the legend of the field as they are now.
void DrawnFilm::show_field() {
  if (field_) stage_.field = field_->look();
  make_room();
}

// Keeps the room of the legend free, where the camera frames the bodies by itself.
void DrawnFilm::make_room() {
  stage_.kept_free = legend_room(stage_);
  stage_.first_camera = camera_at(start_, stage_, 0);
}

void DrawnFilm::hide_legend() {
  stage_.field->title.clear();
  make_room();
}

// Adds a half transparent copy of each body, which moves as another run's body does.
void DrawnFilm::add_ghosts(const SceneDef& scene, const std::vector<Body>& bodies) {
  ghosts_.emplace(scene.look.ghost, scene, bodies);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    DrawMesh ghost = stage_.meshes[b];
    ghost.name.clear();
    ghost.label.clear();
    ghost.layers.clear();
    ghost.square.clear();
    ghost.cloth.reset();
    ghost.surface_colors.clear();
    ghost.color = Vec3(0.604, 0.604, 0.604);  // the grey of references in all plots
    ghost.gloss = 0;
    ghost.finish = {};
    ghost.wires = false;
    ghost.kept_clear = false;
    ghost.ghost = true;
    stage_.meshes.push_back(std::move(ghost));
  }
}

void DrawnFilm::include_in_field(const FramePose& pose, const CollisionSet& set, Threads& threads) {
  if (field_) field_->include(field_->values(pose, set, &threads));
}

void DrawnFilm::frame_motion(std::vector<Vec3> motion) {
  stage_.motion = std::move(motion);
  stage_.first_camera = camera_at(start_, stage_, 0);
}

void DrawnFilm::know_times(std::span<const FrameRow> rows) {
  longest_steps_ = supple::longest_steps(rows);
  stage_.graphs = graph_looks(start_, longest_steps_);
}

void DrawnFilm::settle_field() {
  if (!field_) return;
  field_->settle();
  show_field();
}

void DrawnFilm::follow(const std::vector<TimedChange>& changes, const CollisionSet& set,
                       const std::vector<Body>& bodies) {
  opens_ = opens_ || std::ranges::any_of(changes, changes_shutter);
  for (std::size_t c = 0; c < set.scene_colliders.size(); ++c) {
    const std::string& name = set.scene_colliders[c].def.name;
    // The square that is drawn for a half space depends on the position of the half space.
    const bool moved = is_half_space(set.scene_colliders[c]) &&
                       std::ranges::any_of(changes, [&name](const TimedChange& one) { return one.object == name; });
    if (!moved && !cost_for(name, changes).surface) continue;
    collider_skins_[c] = drawn_collider(set.scene_colliders[c], bounds_at_rest(bodies));
    round_for_cameras(collider_skins_[c], set.scene_colliders[c], cameras_, start_.output.height);
    renewed_.push_back(c);
  }
}

// Adds what a replay has changed of the colours and finishes since the last list.
void DrawnFilm::follow_colors(const SceneDef& scene, DrawList& list) {
  if (stage_.colors != colors_of(scene.look)) list.colors = stage_.colors = colors_of(scene.look);
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    DrawMesh& mesh = stage_.meshes[b];
    const Vec3 color = scene.bodies[b].color.value_or(drawn_[b].color);
    const double gloss = gloss_of(scene.bodies[b]);
    const std::optional<ClothLook> cloth = cloth_look(scene.bodies[b], bodies_[b].description.mesh.rest);
    const bool takes_own = !scene.bodies[b].takes_colors_of_file();  // true once a change has set the body's color
    if (mesh.color == color && mesh.gloss == gloss && mesh.finish == scene.bodies[b].finish && mesh.cloth == cloth &&
        !(takes_own && !mesh.surface_colors.empty()))
      continue;
    if (takes_own) mesh.surface_colors.clear();
    mesh.color = color;
    mesh.gloss = gloss;
    mesh.finish = scene.bodies[b].finish;
    mesh.cloth = cloth;
    list.renewed.emplace_back(b, mesh);
  }
}

// Returns the positions of all meshes, in the order of the stage.
std::vector<std::vector<float>> DrawnFilm::positions(const SceneDef& scene, const FramePose& pose,
                                                     const CollisionSet& set, Threads& threads) {
  DrawList list;
  const std::size_t bodies = pose.motion.size();
  for (std::size_t b = 0; b < bodies; ++b)
    list.positions.push_back(skin_positions(drawn_[b], bodies_[b].description.mesh, *pose.motion[b], &threads));
  add_colliders(set.scene_colliders, collider_skins_, pose.time, list);
  if (supports_) supports_->add_to(list, scene, pose);
  for (std::size_t b = 0; b < bodies && ghosts_; ++b)
    list.positions.push_back(
        skin_positions(drawn_[b], bodies_[b].description.mesh, ghosts_->at(b, pose.frame), &threads));
  return std::move(list.positions);
}

// Returns what the scene's shutter and lens expose a picture to; nothing where the shutter opens for an instant alone
// and the lens is a point.
std::optional<Exposure> DrawnFilm::exposure(const SceneDef& scene, const FramePose& pose, const CollisionSet& set,
                                            const DrawList& list, Threads& threads) {
  const CameraDef& camera = scene.camera;
  if (camera.shutter_deg == 0 && camera.aperture == 0) return std::nullopt;
  Exposure exposure;
  exposure.aperture = camera.aperture;
  exposure.focus = focus_at(scene, list.camera, list.positions);
  exposure.samples = scene.output.blur_samples;
  if (camera.shutter_deg == 0 || pose.before.empty()) return exposure;
  FramePose before = pose;
  before.motion = pose.before;
  before.frame = std::max(0, pose.frame - 1);
  before.time = std::max(0.0, pose.time - pose.interval.value_or(1 / scene.fps));
  exposure.before = positions(scene, before, set, threads);
  exposure.camera_before = camera_at(scene, stage_, before.time, exposure.before);
  exposure.open = camera.shutter_deg / 360;
  return exposure;
}

DrawList DrawnFilm::list(const SceneDef& scene, const FramePose& pose, const CollisionSet& set, Threads& threads) {
  DrawList result;
  const std::size_t bodies = pose.motion.size();
  result.positions = positions(scene, pose, set, threads);
  for (std::size_t b = 0; b < bodies; ++b)
    result.hollow.push_back(cloth_hollows(drawn_[b], bodies_[b], *pose.motion[b]));
  if (field_) {
    const std::vector<std::vector<double>> values = field_->values(pose, set, &threads);
    for (std::size_t b = 0; b < bodies; ++b)
      result.field.push_back(values[b].empty() ? std::vector<float>() : field_->on_skin(drawn_[b], values[b]));
  }
  result.camera = camera_at(scene, stage_, pose.time, result.positions);
  result.followed = followed_at(scene, stage_, result.positions);
  result.exposure = exposure(scene, pose, set, result, threads);
  for (std::size_t b = 0; b < bodies && scene.look.marks; ++b)
    append_marks(bodies_[b], *pose.motion[b], set, pose.time, &threads, result.marks);
  result.headline = headline_text(scene, pose.time);
  result.subtitle = subtitle_text(scene.text, pose.time);
  result.graphs = graph_curves(scene.text, pose.earlier, pose.row, longest_steps_);
  for (std::size_t b = 0; b < bodies && scene.text.notes(); ++b) {
    const BodyRow* row = pose.row != nullptr && b < pose.row->bodies.size() ? &pose.row->bodies[b] : nullptr;
    result.notes.push_back(note_text(scene.text, scene.bodies[b], row));
  }
  follow_colors(scene, result);
  for (const std::size_t c : std::exchange(renewed_, {}))
    result.renewed.emplace_back(bodies + c, collider_mesh(set.scene_colliders[c], collider_skins_[c]));
  for (std::size_t b = 0; b < bodies; ++b) {
    if (!scene.look.show_labels || stage_.meshes[b].label == scene.bodies[b].label) continue;
    stage_.meshes[b].label = scene.bodies[b].label;
    result.captions.emplace_back(b, scene.bodies[b].label);
  }
  return result;
}

}  // namespace supple
