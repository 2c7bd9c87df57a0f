#include "world/world.h"

#include <algorithm>

#include "base/error.h"
#include "base/hash.h"
#include "base/trace.h"
#include "sim/solver/step.h"

namespace supple {

struct World::Parts {
  std::optional<Script> script;
  SceneDef start;  // the scene before any change
  SceneDef scene;  // the scene at the end of the frame that was entered last
  std::vector<Body> bodies;
  CollisionSet colliders;
  std::vector<Model> models;                        // by body, once they are built
  std::vector<std::unique_ptr<MovingBody>> moving;  // by body, once the world is started
  std::unique_ptr<Islands> islands;                 // once the world is started
  int frame = -1;                                   // that was entered last
  double saved_ms = 0;                              // of the frame's steps

  Parts(std::optional<Script> script, SceneDef at_start, std::vector<Body> bodies)
      : script(std::move(script)),
        start(std::move(at_start)),
        scene(start),
        bodies(std::move(bodies)),
        colliders(collision_set(scene)) {}

  // In the frame of a change, positions are interpolated over the substeps, from the values in `earlier` to the new
  // ones. When that frame is over, only the new ones count.
  void end_last_changes() {
    colliders.earlier.clear();
    for (Body& body : bodies) body.earlier.clear();
  }
  void apply(SceneDef changed, const std::vector<TimedChange>& changes);
  // Makes the step of an island that was prepared. Returns whether it succeeded.
  // is_known: whether the watch has been told that it was prepared.
  bool step(const std::vector<std::size_t>& island, int substep, const StepWatch& watch, bool is_known);
  // Makes the steps of all islands.
  bool step_all(const std::vector<std::vector<std::size_t>>& all, int substep, const StepWatch& watch);
};

void World::Parts::apply(SceneDef changed, const std::vector<TimedChange>& changes) {
  const Zone zone("change");
  scene = std::move(changed);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    update_body(bodies[b], scene, scene.bodies[b]);
    if (!moving.empty()) moving[b]->apply(cost_for(bodies[b].def.name, changes));
  }
  CollisionSet now = collision_set(scene);
  now.earlier = std::move(colliders.scene_colliders);
  colliders = std::move(now);
}

World::World(Script script, std::vector<Body> bodies) {
  SceneDef start = script.scene();
  parts_ = std::make_unique<Parts>(std::move(script), std::move(start), std::move(bodies));
}
World::World(SceneDef scene, std::vector<Body> bodies)
    : parts_(std::make_unique<Parts>(std::nullopt, std::move(scene), std::move(bodies))) {}
World::World(World&&) noexcept = default;
World::~World() = default;

const Script& World::script() const { return parts_->script.value(); }
const SceneDef& World::scene() const { return parts_->scene; }
const std::vector<Body>& World::bodies() const { return parts_->bodies; }
const CollisionSet& World::colliders() const { return parts_->colliders; }
const std::vector<BodyTouch>& World::touches() const { return parts_->islands->touches(); }
double World::saved_ms() const { return parts_->saved_ms; }
const JoinedStep& World::joined_step() const { return parts_->islands->last_step(); }
std::size_t World::size() const { return parts_->bodies.size(); }
MovingBody& World::body(std::size_t index) { return *parts_->moving.at(index); }
const MovingBody& World::body(std::size_t index) const { return *parts_->moving.at(index); }

void World::build_models() {
  if (!parts_->models.empty()) return;
  parts_->models.reserve(size());
  for (const Body& body : parts_->bodies) parts_->models.push_back(build_model(body.description));
}

void World::start(const Solvers& solvers, Threads* threads) {
  Parts& parts = *parts_;
  build_models();
  parts.moving.clear();
  const bool was_played = parts.frame >= 0;
  if (was_played) rewind();
  for (std::size_t b = 0; b < size(); ++b) {
    parts.moving.push_back(
        std::make_unique<MovingBody>(parts.scene, parts.bodies[b], parts.models[b], parts.colliders, solvers, threads));
    if (was_played && parts.script) parts.moving[b]->apply(cost_for(parts.bodies[b].def.name, parts.script->changes()));
  }
  parts.islands = std::make_unique<Islands>(parts.scene, parts.moving, solvers, threads);
}

std::vector<TimedChange> World::enter(int frame) {
  Parts& parts = *parts_;
  parts.end_last_changes();
  std::vector<TimedChange> changes;
  for (int next = parts.frame + 1; parts.script && next <= frame; ++next) {
    for (const TimedChange* change : parts.script->at_work(next)) changes.push_back(*change);
  }
  parts.frame = frame;
  if (!changes.empty()) parts.apply(parts.script->scene_at(frame), changes);
  return changes;
}

void World::rewind() {
  Parts& parts = *parts_;
  if (parts.script && !parts.script->changes().empty()) parts.apply(parts.start, parts.script->changes());
  parts.end_last_changes();
  parts.frame = -1;
}

void World::prepare(int substep) {
  for (const auto& body : parts_->moving) body->prepare_step(parts_->frame, substep);
}

bool World::Parts::step(const std::vector<std::size_t>& island, int substep, const StepWatch& watch, bool is_known) {
  for (const std::size_t b : island) {
    if (watch.prepared && !is_known) watch.prepared(b, substep);
  }
  const int failed = islands->step(island);
  for (const std::size_t b : island) {
    if (watch.made && (failed < 0 || b == std::size_t(failed))) watch.made(b, substep);
  }
  return failed < 0;
}

bool World::Parts::step_all(const std::vector<std::vector<std::size_t>>& all, int substep, const StepWatch& watch) {
  const std::vector<std::size_t> independent = islands->find_independent(all);
  std::vector<char> known(bodies.size(), 0), made = known;
  if (!independent.empty()) {
    for (const std::size_t b : independent) {
      known[b] = 1;
      if (watch.prepared) watch.prepared(b, substep);
    }
    for (const std::size_t b : islands->step_at_once(independent)) {
      made[b] = 1;
      if (watch.made) watch.made(b, substep);
    }
    saved_ms += islands->saved_ms();
  }
  return std::ranges::all_of(all, [&](const std::vector<std::size_t>& island) {
    return made[island.front()] != 0 || step(island, substep, watch, known[island.front()] != 0);
  });
}

bool World::step(const StepWatch& watch) {
  parts_->saved_ms = 0;
  for (int substep = 0; substep < parts_->scene.substeps; ++substep) {
    prepare(substep);
    if (!parts_->step_all(parts_->islands->find(), substep, watch)) return false;
  }
  return true;
}

WorldState World::state() const {
  WorldState state{parts_->frame + 1, {}};
  for (const auto& body : parts_->moving) state.bodies.push_back(body->state());
  return state;
}

void World::restore(const WorldState& state) {
  SUPPLE_CHECK(state.bodies.size(), ==, size());
  if (parts_->script && state.frames - 1 < parts_->frame) rewind();
  enter(state.frames - 1);
  parts_->end_last_changes();
  for (std::size_t b = 0; b < size(); ++b) parts_->moving[b]->restore(state.bodies[b]);
}

std::uint64_t World::hash() const {
  std::vector<std::uint64_t> hashes;
  for (const auto& body : parts_->moving) hashes.push_back(state_hash(body->model(), body->state()));
  return hashes.size() == 1 ? hashes.front() : hash_bytes(hashes.data(), sizeof(hashes.front()) * hashes.size());
}

}  // namespace supple
