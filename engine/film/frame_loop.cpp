#include "film/frame_loop.h"

#include <algorithm>

#include "base/frame_time.h"
#include "base/hash.h"
#include "base/interrupts.h"
#include "base/timing.h"
#include "base/trace.h"
#include "film/plan/shipped_files.h"

namespace supple {

FilmEnd FrameLoop::run(Progress& progress, std::string& message) {
  for (int frame = first_; frame < world_.scene().frames; ++frame) {
    if (interrupted()) return FilmEnd::interrupted;
    const Zone zone("frame", {}, frame);
    FrameRow row;
    row.frame = frame;
    row.time_s = frame_time(frame, world_.scene().fps);
    if (log_.keeps_checkpoints()) keep_checkpoint_before();
    enter(frame, row);
    message = step(frame, row);
    if (!message.empty()) return FilmEnd::failed;
    record(frame, row);
    if (!show(frame, row)) return FilmEnd::failed;  // finish() takes the message from the pictures
    if (graphs_) graphed_.push_back(graph_point(row));
    log_.add(std::move(row));
    if (log_.wants_checkpoint(frame + 1)) add_checkpoint();
    log_.settle(written_pictures());
    progress.show(frame + 1);
  }
  return FilmEnd::done;
}

// Enters the frame, with the changes that a replay makes in it.
void FrameLoop::enter(int frame, FrameRow& row) {
  const Stopwatch watch;
  const std::vector<TimedChange> changes = world_.enter(frame);
  if (changes.empty()) return;
  if (drawn_) drawn_->follow(changes, world_.colliders(), world_.bodies());
  row.change_ms = watch.elapsed_ms();
}

// Makes the steps of the frame. Returns why a step failed; empty when none did.
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
  pairs_.record(row);
  save_outputs(frame, row);
}

void FrameLoop::save_outputs(int frame, const FrameRow& row) {
  for (const auto& body : recorders_) body->save_motion();
  if (plan_.fields_every > 0 && frame % plan_.fields_every == 0) {
    for (const auto& body : recorders_) body->save_fields(frame);
  }
  for (const SceneCollider& collider : world_.colliders().scene_colliders)
    poses_->add(frame, collider.def.name, collider.pose(row.time_s));
}

// Hands the frame to the pictures. Returns false when they have failed.
bool FrameLoop::show(int frame, FrameRow& row) {
  if (!pictures_) return true;
  const bool every = plan_.pictures == FilmPictures::all;
  const bool drawn = every ? frame % plan_.pictures_every() == 0 : frame + 1 == world_.scene().frames;
  if (!drawn) {
    keep_motion();
    return true;
  }
  Zone zone("draw list");
  const Stopwatch watch;
  FramePose pose{frame, row.time_s, {}, {}};
  for (const auto& body : recorders_) pose.motion.push_back(&body->saved_motion());
  for (const Positions& body : last_motion_) pose.before.push_back(&body);
  for (const auto& body : recorders_) pose.forces.push_back(&body->saved_forces());
  pose.row = &row;
  pose.earlier = graphed_;
  DrawList list = drawn_->list(world_.scene(), pose, world_.colliders(), threads_);
  keep_motion();
  for (std::size_t b = 0; b < recorders_.size(); ++b) {
    row.bodies[b].skin_excess = drawn_->skin_excess_of(b, list, world_.bodies()[b].description.mesh, *pose.motion[b]);
    row.bodies[b].in_picture = drawn_->share_in_picture(b, list);
  }
  row.draw_ms = watch.elapsed_ms();
  zone.next("wait for render");
  return pictures_->put(every ? frame / plan_.pictures_every() : frame, std::move(list));
}

// Keeps the frame's positions for the next one, where the pictures need them.
void FrameLoop::keep_motion() {
  if (!drawn_->needs_before()) return;
  last_motion_.clear();
  for (const auto& body : recorders_) last_motion_.push_back(body->saved_motion());
}

FrameLoop::FrameLoop(const FilmPlan& plan, LoadedFilm& film, FilmStart& start, const RunFolder& folder,
                     const FilmSolvers& solvers, FilmLog& log, VideoEncoder* video)
    : plan_(plan),
      world_(film.world),
      folder_(folder),
      threads_(film.info.threads),
      first_(start.kept_frames()),
      log_(log),
      graphs_(plan.pictures != FilmPictures::none &&
              (world_.scene().text.error_graph || world_.scene().text.time_graph)),
      verifier_(start.verifier ? &*start.verifier : nullptr),
      errors_(film.world, solvers, threads_),
      pairs_(film.world, log.whole_rows()) {
  if (plan.pictures != FilmPictures::none) {
    drawn_.emplace(world_.script(), world_.bodies(), std::move(film.drawn), world_.colliders(), caption_font());
    if (film.info.framed) drawn_->frame_motion(*film.info.framed);
    pictures_.emplace(drawn_->stage(), plan.gl, shaders_folder(),
                      PictureTargets{folder.frames(), !plan.film_only, video, first_});
  }
  if (graphs_) log_.whole_rows().each([&](const FrameRow& row) { graphed_.push_back(graph_point(row)); });
  world_.start(solvers.steps, &threads_);
  for (std::size_t b = 0; b < world_.size(); ++b) {
    recorders_.push_back(std::make_unique<BodyRecorder>(world_, b, folder, errors_, first_));
    if (!start.repeated.empty()) recorders_.back()->repeat(start.repeated[b]);
  }
  const std::size_t colliders = world_.colliders().scene_colliders.size();
  if (colliders > 0) poses_.emplace(folder.colliders(), first_ * int(colliders));
  if (start.checkpoint) resume(*start.checkpoint);
  if (drawn_ && drawn_->needs_before()) {
    for (const auto& body : recorders_) last_motion_.push_back(body->present_motion());
  }
  if (!plan.record.empty()) states_.emplace(plan.record, start.record_head, first_);
}

// Restores the state at which an earlier run took its checkpoint.
void FrameLoop::resume(const WorldState& checkpoint) {
  world_.restore(checkpoint);
  if (drawn_) drawn_->follow(world_.script().changes(), world_.colliders(), world_.bodies());
  for (std::size_t b = 0; b < recorders_.size(); ++b) recorders_[b]->resume(log_.last_kept().bodies.at(b));
}

void FrameLoop::keep_checkpoint_before() {
  const Zone zone("checkpoint");
  checkpoint_before_ = world_.state();
}

void FrameLoop::add_checkpoint() {
  const Zone zone("checkpoint");
  log_.add(world_.state());
}

void FrameLoop::finish(FilmResult& result) {
  const Zone zone("finish film");
  if (pictures_) {
    pictures_->finish();
    result.gl_backend = pictures_->backend;
    result.gl_renderer = pictures_->renderer;
    result.gl_version = pictures_->version;
  }
  if (pictures_ && !pictures_->error().empty()) {
    result.end = FilmEnd::failed;
    result.message = pictures_->error();
  }
  const int frames = log_.frames();
  // After a failure the bodies may be in the middle of a frame, so the checkpoint before that frame is kept.
  if (result.end == FilmEnd::failed && checkpoint_before_.frames > first_)
    log_.add(checkpoint_before_);  // a checkpoint at first_ is there already
  const bool at_end = result.end != FilmEnd::failed && log_.keeps_checkpoints() && !log_.wants_checkpoint(frames);
  if (at_end) add_checkpoint();
  log_.settle(written_pictures());
}

}  // namespace supple
