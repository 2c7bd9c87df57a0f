#include "film/pictures/world_pictures.h"

#include <algorithm>
#include <exception>
#include <future>
#include <thread>
#include <utility>

#include "base/queue.h"
#include "base/signals.h"
#include "film/pictures/drawn_film.h"
#include "film/pictures/surface_field.h"
#include "film/plan/shipped_files.h"
#include "render/renderer.h"
#include "sim/measures/fields.h"

namespace supple {

// Holds what pictures with the same settings, but for the camera, have in common: skins, stage and renderer. The
// renderer lives on a thread of its own, as OpenGL wants it, so that pictures can be asked for by any thread.
class WorldPictures::Studio {
 public:
  Studio(const Script& script, const World& world, std::vector<DrawnBody> drawn, std::string key)
      : key_(std::move(key)),
        film_(script, world.bodies(), std::move(drawn), world.colliders(), text_font(script.scene().text)),
        nearest_(distance_of(film_.stage().first_camera)) {
    const BlockedSignals meanwhile;  // the thread that asks for pictures takes signals
    thread_ = std::thread([this] { draw_all(); });
  }
  ~Studio() {
    orders_.close();
    thread_.join();
  }
  Studio(const Studio&) = delete;
  Studio& operator=(const Studio&) = delete;

  const std::string& key() const { return key_; }
  DrawnFilm& film() { return film_; }
  // Follows what changes have made of the colliders, also those that hold no more because a state was restored.
  void follow(const std::vector<TimedChange>& changes, const World& world) {
    std::vector<TimedChange> all = std::exchange(followed_, changes);
    all.insert(all.end(), changes.begin(), changes.end());
    if (!all.empty()) film_.follow(all, world.colliders(), world.bodies());
  }
  // Tells whether the skins are fine enough for a camera: they are fitted to the one that they were made for.
  bool suits(const Camera& camera) const { return distance_of(camera) > 0.8 * nearest_; }

  Image draw(DrawList list) {
    std::promise<Image> promise;
    std::future<Image> picture = promise.get_future();
    orders_.push({std::move(list), std::move(promise)});
    return picture.get();
  }

 private:
  using Order = std::pair<DrawList, std::promise<Image>>;

  static double distance_of(const Camera& camera) { return (camera.eye - camera.target).norm(); }

  void draw_all() {
    std::unique_ptr<Renderer> renderer;
    while (auto order = orders_.pop()) {
      try {
        if (!renderer) renderer = std::make_unique<Renderer>(film_.stage(), GlChoice::automatic, shaders_folder());
        order->second.set_value(renderer->draw(order->first));
      } catch (...) {
        order->second.set_exception(std::current_exception());
      }
    }
  }

  std::string key_;
  DrawnFilm film_;
  std::vector<TimedChange> followed_;
  double nearest_;  // distance of the camera that the skins are fitted to [m]
  BoundedQueue<Order> orders_{1};
  std::thread thread_;
};

// Holds the world as pictures and fields take it.
struct WorldPictures::Pose {
  std::vector<Positions> motion, before, forces;
  FramePose frame;
};

WorldPictures::WorldPictures(World& world, Threads& threads) : world_(world), threads_(threads) {}
WorldPictures::~WorldPictures() = default;

WorldPictures::Pose WorldPictures::present_pose() {
  Pose pose;
  const int frames = world_.frames();
  for (std::size_t b = 0; b < world_.size(); ++b) {
    MovingBody& body = world_.body(b);
    pose.motion.push_back(in_input_order(body.model(), body.state().x));
    pose.before.push_back(pose.motion.back() - in_input_order(body.model(), body.state().v) / world_.scene().fps);
    if (world_.scene().may_touch() && world_.has_stepped()) {
      pose.forces.push_back(contact_forces(body.model(), body.workspace(), body.state().x));
    } else {
      pose.forces.push_back(Positions::Zero(pose.motion.back().rows(), 3));
    }
  }
  pose.frame.frame = std::max(frames - 1, 0);
  pose.frame.time = world_.scene().time_after(frames - 1);
  const auto point_to = [](const std::vector<Positions>& from, std::vector<const Positions*>& to) {
    for (const Positions& one : from) to.push_back(&one);
  };
  point_to(pose.motion, pose.frame.motion);
  point_to(pose.before, pose.frame.before);
  point_to(pose.forces, pose.frame.forces);
  return pose;
}

Image WorldPictures::draw(const std::vector<std::string>& settings) {
  const Script script = world_.script().with(settings);
  const int frame = world_.frames() - 1;
  const SceneDef scene = frame < 0 ? script.scene() : script.scene_at(frame);
  std::string key;
  for (const std::string& setting : settings) {
    if (!setting.starts_with("camera")) key += setting + '\n';
  }
  std::vector<DrawnBody>& drawn = scene.look.wireframe ? elements_ : skins_;
  if (drawn.empty()) {
    drawn = drawn_bodies(world_.bodies(), {UserCache::of_user(), {}},
                         scene.look.wireframe ? DrawnAs::elements : DrawnAs::skin);
  }
  const Pose pose = present_pose();
  for (const bool fresh : {false, true}) {
    if (fresh || !studio_ || studio_->key() != key) studio_ = std::make_unique<Studio>(script, world_, drawn, key);
    DrawnFilm& film = studio_->film();
    studio_->follow(script.changes(), world_);
    DrawList list = film.list(scene, pose.frame, world_.colliders(), threads_);
    if (fresh || studio_->suits(list.camera)) return studio_->draw(std::move(list));
  }
  return {};  // not reached
}

std::vector<std::vector<double>> WorldPictures::field(FieldQuantity quantity) {
  SceneDef scene = world_.scene();
  scene.field.quantity = quantity;
  SurfaceField field(scene, world_.bodies());
  const Pose pose = present_pose();
  return field.values(pose.frame, world_.colliders(), &threads_);
}

}  // namespace supple
