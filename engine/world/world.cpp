#include "world/world.h"

#include <algorithm>

#include "base/error.h"
#include "base/hash.h"
#include "base/text.h"
#include "base/trace.h"
#include "sim/solver/step.h"
#include "world/attached_handles.h"
#include "world/islands.h"

namespace supple {

struct World::Parts {
  std::optional<Script> script;
  SceneDef start;  // the scene before any change
  SceneDef scene;  // the scene at the end of the frame that was entered last
  std::vector<Body> bodies;
  CollisionSet colliders;
  std::vector<Model> models;                               // by body, once they are built
  std::vector<std::unique_ptr<MovingBody>> moving;         // by body, once the world is started
  std::vector<std::unique_ptr<AttachedHandles>> attached;  // of bodies that have such handles
  std::unique_ptr<Islands> islands;                        // once the world is started
  int frame = -1;                                          // the frame that was entered last; -1: none
  int substep = 0;                                         // the next substep of that frame to be made
  bool has_failed = false;                                 // whether a step of that frame has failed
  bool has_stepped = false;  // whether a step was made since the world was started or restored
  double saved_ms = 0;       // what World::saved_ms() returns [ms]

  Parts(std::optional<Script> played, SceneDef at_start, std::vector<Body> assembled)
      : script(std::move(played)),
        start(std::move(at_start)),
        scene(start),
        bodies(std::move(assembled)),
        colliders(collision_set(scene)) {}

  // Forgets the values before the last changes. In the frame of a change, positions are interpolated over the substeps,
  // from these values to the new ones; when that frame is over, only the new ones count.
  void end_last_changes() {
    colliders.earlier.clear();
    for (Body& body : bodies) body.earlier.clear();
  }
  void apply(SceneDef changed, const std::vector<TimedChange>& changes);
  void begin_frame() {
    substep = 0;
    has_failed = false;
  }
  // Returns when the next frame begins [s].
  double next_time() const { return scene.time_after(frame); }
  void take_edits(LiveEdits edits);
  // Changes the scene before its first frame.
  void begin_with(SceneDef changed, const std::vector<TimedChange>& changes) {
    start = changed;
    apply(std::move(changed), changes);
    end_last_changes();
  }
  void attach_handles();
  // Makes the step of an island that was prepared. Returns whether it succeeded. number: the number of the substep in
  // its frame. is_known: whether the watch has been told that it was prepared.
  bool step(const std::vector<std::size_t>& island, int number, const StepWatch& watch, bool is_known);
  // Makes the steps of all islands. Returns whether they succeeded.
  bool step_all(const std::vector<std::vector<std::size_t>>& all, int number, const StepWatch& watch);
};

void World::Parts::apply(SceneDef changed, const std::vector<TimedChange>& changes) {
  const Zone zone("change");
  scene = std::move(changed);
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    update_body(bodies[b], scene, scene.bodies[b]);
    if (!moving.empty()) moving[b]->apply(cost_for(bodies[b].def.table, changes));
  }
  CollisionSet now = collision_set(scene);
  now.earlier = std::move(colliders.scene_colliders);
  colliders = std::move(now);
}

void World::Parts::attach_handles() {
  attached.clear();
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    auto handles = std::make_unique<AttachedHandles>(moving, b, colliders);
    if (handles->empty()) continue;
    moving[b]->attach([put = handles.get()](double time, Positions& targets) { put->put(time, targets); });
    attached.push_back(std::move(handles));
  }
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

void World::begin_from(std::size_t body, EarlierState state) { parts_->bodies.at(body).from = std::move(state); }

void World::build_models() {
  if (!parts_->models.empty()) return;
  parts_->models.reserve(size());
  for (const Body& body : parts_->bodies) parts_->models.push_back(build_model(body.description));
}

void World::start(const Solvers& solvers, Threads* threads) {
  Parts& parts = *parts_;
  build_models();
  parts.moving.clear();
  parts.has_stepped = false;
  const bool was_played = parts.frame >= 0;
  if (was_played) rewind();
  for (std::size_t b = 0; b < size(); ++b) {
    parts.moving.push_back(
        std::make_unique<MovingBody>(parts.scene, parts.bodies[b], parts.models[b], parts.colliders, solvers, threads));
    if (was_played && parts.script)
      parts.moving[b]->apply(cost_for(parts.bodies[b].def.table, parts.script->changes()));
  }
  parts.attach_handles();
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
  parts.begin_frame();
  if (!changes.empty()) parts.apply(parts.script->scene_at(frame), changes);
  return changes;
}

void World::rewind() {
  Parts& parts = *parts_;
  if (parts.script && !parts.script->changes().empty()) parts.apply(parts.start, parts.script->changes());
  parts.end_last_changes();
  parts.frame = -1;
  parts.begin_frame();
}

std::size_t World::body_named(const std::string& name) const {
  std::vector<std::string> names;
  for (const Body& body : parts_->bodies) names.push_back(body.def.name);
  const auto found = std::ranges::find(names, name);
  if (found == names.end()) {
    throw InputError(name,
                     fmt::format("there is no such body: there is {}{}", word_list(names), did_you_mean(name, names)));
  }
  return static_cast<std::size_t>(found - names.begin());
}

void World::change(TimedChange change) {
  Parts& parts = *parts_;
  Script& script = parts.script.value();
  const bool begins = parts.frame < 0;  // before the first frame, the scene at the start changes
  change.at = parts.next_time();
  script.add(std::move(change));
  const TimedChange added = script.edits().changes.back();
  try {
    SceneDef scene = begins ? script.scene() : script.scene_at(parts.frame + 1);
    for (std::size_t b = 0; b < size() && (added.cost.factor || added.cost.trial); ++b) {
      if (!added.object.empty() && added.object != parts.bodies[b].def.table) continue;
      Body trial = parts.bodies[b];
      update_body(trial, scene, scene.bodies[b]);
    }
    if (begins) parts.begin_with(std::move(scene), {added});
  } catch (...) {
    LiveEdits before = script.edits();
    before.changes.pop_back();
    script.set_edits(std::move(before));
    if (begins) parts.begin_with(script.scene(), {added});
    throw;
  }
}

void World::grab(LiveGrab grab) {
  Parts& parts = *parts_;
  Script& script = parts.script.value();
  const std::size_t b = body_named(grab.body);
  Body& body = parts.bodies[b];
  if (body.def.table != body.def.name) {
    throw InputError(grab.body,
                     fmt::format("is a piece or a copy of '{}', with which it has its handles in common: it cannot be "
                                 "grabbed by itself",
                                 body.def.table));
  }
  grab.from = parts.next_time();
  grab.until = std::numeric_limits<double>::infinity();
  script.add(grab);
  const HandleDef def = script.scene().bodies.at(b).handles.back();
  std::vector<Problem> problems;
  body.def.handles.push_back(def);
  add_handle(body, def, problems);
  if (!problems.empty()) {
    body.def.handles.pop_back();
    body.description.handles.resize(body.def.handles.size());
    body.motions.resize(body.def.handles.size());
    LiveEdits before = script.edits();
    before.grabs.pop_back();
    script.set_edits(std::move(before));
    throw InputError(std::move(problems));
  }
  // Vertices that another handle has are left out for good, also after that handle has ended.
  LiveEdits edits = script.edits();
  edits.grabs.back().vertices.clear();
  for (const std::int32_t v : body.description.handles.back().vertices) edits.grabs.back().vertices.push_back(v + 1);
  script.set_edits(std::move(edits));
  parts.start = script.scene();
  parts.scene.bodies[b].handles.push_back(parts.start.bodies[b].handles.back());
  body.def.handles.back() = parts.start.bodies[b].handles.back();
  parts.moving[b]->add_handle();
}

void World::release(const std::string& name, const std::string& handle) {
  Parts& parts = *parts_;
  Script& script = parts.script.value();
  const std::size_t b = body_named(name);
  const std::string place = fmt::format("handle '{}' of body '{}'", handle, name);
  const double until = parts.next_time();
  const auto& grabs = script.edits().grabs;
  const auto grab = std::ranges::find_if(
      grabs, [&](const LiveGrab& one) { return one.body == name && one.name == handle && one.until > until; });
  if (grab == grabs.end()) throw InputError(place, "grabbed nothing in this world, or has let go already");
  if (grab->from >= until) throw InputError(place, "takes hold in the next step, and can be released after it");
  script.end_grab(name, handle, until);
  parts.start = script.scene();
  for (auto* handles : {&parts.bodies[b].def.handles, &parts.scene.bodies[b].handles})
    std::ranges::find(*handles, handle, &HandleDef::name)->until = until;
}

// Puts the world back before its first frame, with other edits. The states stay.
void World::Parts::take_edits(LiveEdits edits) {
  std::vector<TimedChange> changes = script->changes();
  std::vector<std::size_t> kept;  // handles of each body that no edit made
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const auto made = std::ranges::count(script->edits().grabs, bodies[b].def.name, &LiveGrab::body);
    kept.push_back(bodies[b].def.handles.size() - std::size_t(made));
  }
  script->set_edits(std::move(edits));
  changes.insert(changes.end(), script->changes().begin(), script->changes().end());
  start = script->scene();
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (kept[b] == bodies[b].def.handles.size() && kept[b] == start.bodies[b].handles.size()) continue;
    moving[b]->keep_handles(kept[b]);
    for (std::size_t h = kept[b]; h < start.bodies[b].handles.size(); ++h) {
      std::vector<Problem> none;  // they were there once
      bodies[b].def.handles.push_back(start.bodies[b].handles[h]);
      add_handle(bodies[b], bodies[b].def.handles.back(), none);
      moving[b]->add_handle();
    }
  }
  begin_with(script->scene(), changes);
  frame = -1;
}

void World::prepare(int substep) {
  const SceneDef& scene = parts_->scene;
  const int frame = scene.frames_before() + parts_->frame;
  const double done = static_cast<double>(frame) * scene.substeps + substep;
  if (!parts_->colliders.deformed.empty()) {
    const Zone zone("deform colliders");
    deform_colliders(parts_->colliders, done * scene.time_step(), (done + 1) * scene.time_step());
  }
  for (const auto& body : parts_->moving) body->prepare_step(frame, substep);
}

bool World::Parts::step(const std::vector<std::size_t>& island, int number, const StepWatch& watch, bool is_known) {
  for (const std::size_t b : island) {
    if (watch.prepared && !is_known) watch.prepared(b, number);
  }
  const int failed = islands->step(island);
  for (const std::size_t b : island) {
    if (watch.made && (failed < 0 || b == std::size_t(failed))) watch.made(b, number);
  }
  return failed < 0;
}

bool World::Parts::step_all(const std::vector<std::vector<std::size_t>>& all, int number, const StepWatch& watch) {
  const std::vector<std::size_t> independent = islands->find_independent(all);
  std::vector<char> known(bodies.size(), 0), made = known;
  if (!independent.empty()) {
    for (const std::size_t b : independent) {
      known[b] = 1;
      if (watch.prepared) watch.prepared(b, number);
    }
    for (const std::size_t b : islands->step_at_once(independent)) {
      made[b] = 1;
      if (watch.made) watch.made(b, number);
    }
    saved_ms += islands->saved_ms();
  }
  return std::ranges::all_of(all, [&](const std::vector<std::size_t>& island) {
    return made[island.front()] != 0 || step(island, number, watch, known[island.front()] != 0);
  });
}

bool World::step(const StepWatch& watch) {
  Parts& parts = *parts_;
  if (parts.substep == 0) parts.saved_ms = 0;
  parts.has_stepped = true;
  for (bool first = true; parts.substep < parts.scene.substeps; first = false) {
    if (!first && watch.stops && watch.stops()) return false;
    prepare(parts.substep);
    if (!parts.step_all(parts.islands->find(), parts.substep, watch)) {
      parts.has_failed = true;
      return false;
    }
    ++parts.substep;
  }
  return true;
}

bool World::has_stepped() const { return parts_->has_stepped; }

int World::frames() const { return parts_->frame + 1; }

bool World::is_within_frame() const {
  return parts_->has_failed || (parts_->substep > 0 && parts_->substep < parts_->scene.substeps);
}

WorldState World::state() const {
  WorldState state{parts_->frame + 1, {}, parts_->script ? parts_->script->edits() : LiveEdits{}};
  for (const auto& body : parts_->moving) state.bodies.push_back(body->state());
  return state;
}

void World::restore(const WorldState& state) {
  SUPPLE_CHECK(state.bodies.size(), ==, size());
  if (parts_->script && !(state.edits.empty() && parts_->script->edits().empty())) parts_->take_edits(state.edits);
  if (parts_->script && state.frames - 1 < parts_->frame) rewind();
  enter(state.frames - 1);
  parts_->end_last_changes();
  parts_->has_stepped = false;
  for (std::size_t b = 0; b < size(); ++b) parts_->moving[b]->restore(state.bodies[b]);
}

std::uint64_t World::hash() const {
  std::vector<std::uint64_t> hashes;
  for (const auto& body : parts_->moving) hashes.push_back(state_hash(body->model(), body->state()));
  return hashes.size() == 1 ? hashes.front() : hash_bytes(hashes.data(), sizeof(hashes.front()) * hashes.size());
}

}  // namespace supple
