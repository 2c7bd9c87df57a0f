#include "film/frame_loop.h"

#include <algorithm>

#include "base/timing.h"
#include "base/trace.h"
#include "base/user_cache.h"
#include "film/plan/shipped_files.h"

namespace supple {

FilmEnd FrameLoop::run(FrameGuide& guide, std::string& message) {
  for (;;) {
    if (const std::optional<FilmEnd> end = guide.ends()) return *end;
    const int frame = world_.frames();
    const Zone zone("frame", {}, frame);
    guide.begin();
    FrameRow row;
    row.frame = frame;
    row.time_s = world_.scene().time_after(frame);
    enter(frame, row);
    message = step(frame, row);
    if (!message.empty()) return FilmEnd::failed;
    record(frame, row);
    if (!show(frame, row)) return FilmEnd::failed;
    if (graphs_) graphed_.push_back(graph_point(row));
    guide.take(std::move(row));
  }
}

// Enters the frame, with the changes that a replay makes in it.
void FrameLoop::enter(int frame, FrameRow& row) {
  const Stopwatch watch;
  const std::vector<TimedChange> changes = world_.enter(frame);
  if (changes.empty()) return;
  if (drawn_) drawn_->follow(changes, world_.colliders(), world_.bodies());
  row.change_ms = watch.elapsed_ms();
}

// Makes the steps of the frame. Returns why a step failed, or how the states differ from those of --verify; empty where
// neither is so.
std::string FrameLoop::step(int frame, FrameRow& row) {
  const bool measure_error = plan_.error_every > 0 && frame % plan_.error_every == 0;
  row.bodies.resize(recorders_.size());
  for (std::size_t b = 0; b < recorders_.size(); ++b) recorders_[b]->begin_frame(frame, measure_error, row.bodies[b]);
  if (std::ranges::find(plan_.save_states, frame) != plan_.save_states.end()) {
    world_.prepare(0);
    for (const auto& body : recorders_) body->save_problem(frame);
  }
  const bool made = world_.step({[this](std::size_t body, int substep) { recorders_[body]->before_step(substep); },
                                 [this](std::size_t body, int substep) { recorders_[body]->after_step(substep); }});
  if (made) return compare_with_record(frame);
  for (const auto& body : recorders_) {
    if (std::string failure = body->failure(); !failure.empty()) return failure;
  }
  return "";
}

// Compares the states with those of another run. Returns how they differ; empty where they do not.
std::string FrameLoop::compare_with_record(int frame) {
  std::string difference;
  for (std::size_t b = 0; verifier_ != nullptr && b < world_.size() && difference.empty(); ++b)
    difference = verifier_->compare(frame, world_.body(b).model(), world_.body(b).state());
  return difference;
}

// Completes the row of a frame whose steps are made, and writes what the film keeps of the frame.
void FrameLoop::record(int frame, FrameRow& row) {
  for (const auto& body : recorders_) body->end_frame();
  for (const BodyRow& body : row.bodies) row.step_ms += body.step_ms;
  row.step_ms -= world_.saved_ms();
  for (std::size_t b = 0; states_ && b < world_.size(); ++b)
    states_->add(world_.body(b).model(), world_.body(b).state());
  row.state_hash = world_.hash();
  const std::vector<std::uint64_t>& played = world_.script().session().hashes;
  if (compares_session_ && std::size_t(frame) < played.size())
    row.as_in_session = row.state_hash == played[std::size_t(frame)];
  pairs_->record(row);
  save_outputs(frame, row);
}

void FrameLoop::save_outputs(int frame, const FrameRow& row) {
  for (const auto& body : recorders_) body->save_motion();
  if (plan_.fields_every > 0 && frame % plan_.fields_every == 0) {
    for (const auto& body : recorders_) body->save_fields(frame);
  }
  if (!poses_) return;
  for (const SceneCollider& collider : world_.colliders().scene_colliders)
    poses_->add(frame, collider.def.name, collider.pose(row.time_s));
}

// Hands the frame to the pictures. Returns false when they have failed.
bool FrameLoop::show(int frame, FrameRow& row) {
  if (pictures_ == nullptr) return true;
  const bool every = plan_.pictures == FilmPictures::all;
  const bool drawn = every ? frame % plan_.pictures_every() == 0 : frame + 1 == world_.scene().frames;
  if (!drawn) {
    keep_motion();
    return true;
  }
  Zone zone("draw list");
  const Stopwatch watch;
  DrawList list = list_of(frame, row.time_s, &row);
  keep_motion();
  for (std::size_t b = 0; b < recorders_.size(); ++b) {
    const Positions& motion = recorders_[b]->saved_motion();
    row.bodies[b].skin_excess = drawn_->skin_excess_of(b, list, world_.bodies()[b].description.mesh, motion);
    row.bodies[b].in_picture = drawn_->share_in_picture(b, list);
  }
  row.draw_ms = watch.elapsed_ms();
  zone.next("wait for render");
  return pictures_->put(every ? frame / plan_.pictures_every() : frame, std::move(list));
}

// Makes the draw list of the motion that the recorders have saved. row: null where the frame's row is not known.
DrawList FrameLoop::list_of(int frame, double time, const FrameRow* row) {
  FramePose pose{frame, time, {}, {}};
  for (const auto& body : recorders_) pose.motion.push_back(&body->saved_motion());
  for (const Positions& body : last_motion_) pose.before.push_back(&body);
  for (const auto& body : recorders_) pose.forces.push_back(&body->saved_forces());
  pose.row = row;
  pose.earlier = graphed_;
  if (!look_) return drawn_->list(world_.scene(), pose, world_.colliders(), threads_);
  SceneDef scene = world_.scene();
  scene.look.wireframe = look_->look.wireframe;
  scene.look.marks = look_->look.marks;
  scene.field = look_->field;
  return drawn_->list(scene, pose, world_.colliders(), threads_);
}

void FrameLoop::end_repeats() {
  for (const auto& body : recorders_) body->end_repeats();
}

DrawList FrameLoop::present_list() {
  for (const auto& body : recorders_) body->note_motion();
  return list_of(std::max(world_.frames() - 1, 0), world_.scene().time_after(world_.frames() - 1), nullptr);
}

bool FrameLoop::show_again() {
  return pictures_ == nullptr || pictures_->put(std::max(world_.frames() - 1, 0), present_list());
}

// Keeps the frame's positions for the next one, where the pictures need them.
void FrameLoop::keep_motion() {
  if (!drawn_->needs_before()) return;
  last_motion_.clear();
  for (const auto& body : recorders_) last_motion_.push_back(body->saved_motion());
}

FrameLoop::FrameLoop(const FilmPlan& plan, LoadedFilm& film, FilmStart& start, const RunFolder* folder,
                     const FilmSolvers& solvers, const FrameRows& earlier)
    : plan_(plan),
      world_(film.world),
      threads_(film.info.threads),
      graphs_(plan.pictures != FilmPictures::none &&
              (world_.scene().text.error_graph || world_.scene().text.time_graph)),
      verifier_(start.verifier ? &*start.verifier : nullptr),
      compares_session_(folder != nullptr),
      errors_(film.world, solvers, threads_) {
  if (plan.pictures != FilmPictures::none) {
    drawn_.emplace(world_.script(), world_.bodies(), std::move(film.drawn), world_.colliders(),
                   text_font(world_.script().scene().text));
    if (!film.info.framed.empty()) drawn_->frame_motion(film.info.framed);
  }
  world_.start(solvers.steps, &threads_);
  const int first = start.kept_frames();
  for (std::size_t b = 0; b < world_.size(); ++b) {
    recorders_.push_back(std::make_unique<BodyRecorder>(world_, b, folder, errors_, first));
    if (!start.repeated.empty()) recorders_.back()->repeat(start.repeated[b]);
  }
  const std::size_t colliders = world_.colliders().scene_colliders.size();
  if (colliders > 0 && folder != nullptr) poses_.emplace(folder->colliders(), first * int(colliders));
  if (start.checkpoint) {
    go_to(*start.checkpoint, earlier);
  } else {
    continue_after(earlier);
  }
  if (!plan.record.empty()) states_.emplace(plan.record, start.record_head, first);
}

void FrameLoop::go_to(const WorldState& state, const FrameRows& before) {
  std::vector<TimedChange> changes = world_.script().changes();  // those that hold no more count, too
  world_.restore(state);
  changes.insert(changes.end(), world_.script().changes().begin(), world_.script().changes().end());
  if (drawn_ && !changes.empty()) drawn_->follow(changes, world_.colliders(), world_.bodies());
  continue_after(before);
}

// Lets the recorders continue after these frames.
void FrameLoop::continue_after(const FrameRows& before) {
  pairs_.emplace(world_, before);
  graphed_.clear();
  std::vector<BodyRow> last;
  before.each([&](const FrameRow& row) {
    if (graphs_) graphed_.push_back(graph_point(row));
    last = row.bodies;
  });
  for (std::size_t b = 0; b < recorders_.size(); ++b) recorders_[b]->resume(b < last.size() ? last[b] : BodyRow{});
  if (!drawn_ || !drawn_->needs_before()) return;
  last_motion_.clear();
  for (const auto& body : recorders_) last_motion_.push_back(body->present_motion());
}

void FrameLoop::change_look(const std::vector<std::string>& settings) {
  const Script script = world_.script().with(settings);
  const bool as_elements = script.scene().look.wireframe;
  std::vector<DrawnBody>& drawn = as_elements ? elements_ : skins_;
  if (drawn.empty()) {
    drawn = drawn_bodies(world_.bodies(), {plan_.cache ? UserCache::of_user() : UserCache(), {}},
                         as_elements ? DrawnAs::elements : DrawnAs::skin);
  }
  DrawnFilm film(script, world_.bodies(), drawn, world_.colliders(), text_font(script.scene().text));
  drawn_.emplace(std::move(film));
  look_ = script.scene();
  last_motion_.clear();
  if (!drawn_->needs_before()) return;
  for (const auto& body : recorders_) last_motion_.push_back(body->present_motion());
}

}  // namespace supple
