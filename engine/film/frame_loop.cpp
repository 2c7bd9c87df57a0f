#include "film/frame_loop.h"

#include <algorithm>

#include "base/frame_time.h"
#include "base/hash.h"
#include "base/interrupts.h"
#include "base/timing.h"
#include "base/trace.h"
#include "film/plan/shipped_files.h"
#include "scene/building/warnings.h"

namespace supple {

FilmEnd FrameLoop::run(Progress& progress, std::string& message) {
  for (int frame = first_; frame < scene_.frames; ++frame) {
    if (interrupted()) return FilmEnd::interrupted;
    const Zone zone("frame", {}, frame);
    FrameRow row;
    row.frame = frame;
    row.time_s = frame_time(frame, scene_.fps);
    if (log_.keeps_checkpoints()) keep_checkpoint_before(frame);
    apply_replay(frame, row);
    message = step_bodies(frame, row);
    if (!message.empty()) return FilmEnd::failed;
    find_meetings(row);
    save_outputs(frame, row);
    if (!show(frame, row)) return FilmEnd::failed;  // finish() takes the message from the pictures
    if (graphs_) graphed_.push_back(graph_point(row));
    log_.add(std::move(row));
    if (log_.wants_checkpoint(frame + 1)) add_checkpoint(frame + 1);
    log_.settle(written_pictures());
    progress.show(frame + 1);
  }
  return FilmEnd::done;
}

// Applies the changes of a replay in this frame.
void FrameLoop::apply_replay(int frame, FrameRow& row) {
  end_last_changes();
  const std::vector<const TimedChange*> at_work = script_.at_work(frame);
  if (at_work.empty()) return;
  const Zone zone("change");
  const Stopwatch watch;
  std::vector<TimedChange> changes;
  for (const TimedChange* one : at_work) changes.push_back(*one);
  apply(script_.scene_at(frame), changes);
  row.change_ms = watch.elapsed_ms();
}

// Makes one frame's steps of all bodies: FilmedBody::advance prepares and makes each of them by its DrivenBody, which
// calls step() (sim/solver/step.h). Returns why it failed, or nothing when it did not.
std::string FrameLoop::step_bodies(int frame, FrameRow& row) {
  const bool save_states = std::ranges::find(plan_.save_states, frame) != plan_.save_states.end();
  std::vector<std::uint64_t> hashes;
  for (const auto& body : filmed_) {
    if (save_states) body->save_problem(frame);
    std::string message = step_body(frame, *body, row);
    if (!message.empty()) return message;
    hashes.push_back(state_hash(body->model(), body->state()));
    if (verifier_ != nullptr) message = verifier_->compare(frame, body->model(), body->state());
    if (!message.empty()) return message;
  }
  // A record holds whole frames: nothing is added before every body has made its steps.
  for (const auto& body : filmed_) {
    if (recorder_) recorder_->add(body->model(), body->state());
  }
  // The hash of a single body is the frame's; for several bodies it is the XXH64 of their hashes in the order of the
  // scene.
  row.state_hash =
      hashes.size() == 1 ? hashes.front() : hash_bytes(hashes.data(), sizeof(hashes.front()) * hashes.size());
  return "";
}

std::string FrameLoop::step_body(int frame, FilmedBody& body, FrameRow& row) {
  const bool measure_error = plan_.error_every > 0 && frame % plan_.error_every == 0;
  row.bodies.emplace_back();
  std::string message = body.advance(frame, measure_error, row.bodies.back());
  if (message.empty()) row.step_ms += row.bodies.back().step_ms;
  return message;
}

// Notes the bodies that have met in this frame.
void FrameLoop::find_meetings(FrameRow& row) {
  if (meetings_.none_left()) return;
  const Zone zone("meetings");
  std::vector<Positions> points;
  for (const auto& body : filmed_) points.push_back(in_input_order(body->model(), body->state().x));
  for (const auto& [a, b] : meetings_.find(points)) row.met.push_back({bodies_[a].def.name, bodies_[b].def.name});
}

void FrameLoop::save_outputs(int frame, const FrameRow& row) {
  for (const auto& body : filmed_) body->save_motion();
  if (plan_.fields_every > 0 && frame % plan_.fields_every == 0) {
    for (const auto& body : filmed_) body->save_fields(frame);
  }
  for (const SceneCollider& collider : colliders_.scene_colliders)
    poses_->add(frame, collider.def.name, collider.pose(row.time_s));
}

// Hands the frame to the pictures. Returns false when they have failed.
bool FrameLoop::show(int frame, FrameRow& row) {
  if (!pictures_) return true;
  const bool every = plan_.pictures == FilmPictures::all;
  const bool drawn = every ? frame % plan_.pictures_every() == 0 : frame + 1 == scene_.frames;
  if (!drawn) {
    keep_motion();
    return true;
  }
  Zone zone("draw list");
  const Stopwatch watch;
  FramePose pose{frame, row.time_s, {}, {}};
  for (const auto& body : filmed_) pose.motion.push_back(&body->saved_motion());
  for (const Positions& body : last_motion_) pose.before.push_back(&body);
  for (const auto& body : filmed_) pose.forces.push_back(&body->saved_forces());
  pose.row = &row;
  pose.earlier = graphed_;
  DrawList list = drawn_->list(scene_, pose, colliders_, threads_);
  keep_motion();
  for (std::size_t b = 0; b < filmed_.size(); ++b) {
    row.bodies[b].skin_excess = drawn_->skin_excess_of(b, list, bodies_[b].description.mesh, *pose.motion[b]);
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
  for (const auto& body : filmed_) last_motion_.push_back(body->saved_motion());
}

FrameLoop::FrameLoop(const FilmPlan& plan, LoadedFilm& film, FilmStart& start, const RunFolder& folder,
                     const FilmSolvers& solvers, FilmLog& log, VideoEncoder* video)
    : plan_(plan),
      script_(film.script),
      bodies_(film.bodies),
      folder_(folder),
      scene_(film.script.scene()),
      colliders_(collision_set(scene_)),
      threads_(film.info.threads),
      first_(start.kept_frames()),
      log_(log),
      graphs_(plan.pictures != FilmPictures::none && (scene_.text.error_graph || scene_.text.time_graph)),
      verifier_(start.verifier ? &*start.verifier : nullptr),
      meetings_(film.bodies) {
  look_for_meetings();
  if (plan.pictures != FilmPictures::none) {
    drawn_.emplace(script_, bodies_, std::move(film.drawn), colliders_, caption_font());
    if (film.info.framed) drawn_->frame_motion(*film.info.framed);
    pictures_.emplace(drawn_->stage(), plan.gl, shaders_folder(),
                      PictureTargets{folder.frames(), !plan.film_only, video, first_});
  }
  if (graphs_) log_.whole_rows().each([&](const FrameRow& row) { graphed_.push_back(graph_point(row)); });
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    filmed_.push_back(std::make_unique<FilmedBody>(scene_, bodies_[b], film.models[b], colliders_, folder, solvers,
                                                   threads_, first_));
    if (!start.repeated.empty()) filmed_.back()->repeat(start.repeated[b]);
  }
  if (!colliders_.scene_colliders.empty())
    poses_.emplace(folder.colliders(), first_ * int(colliders_.scene_colliders.size()));
  if (start.checkpoint) resume(*start.checkpoint);
  if (drawn_ && drawn_->needs_before()) {
    for (const auto& body : filmed_) last_motion_.push_back(body->present_motion());
  }
  if (!plan.record.empty()) recorder_.emplace(plan.record, start.record_head, first_);
}

// Leaves out the pairs of bodies whose meeting is meant, and those that met in the frames of an earlier run.
void FrameLoop::look_for_meetings() {
  if (meetings_.none_left()) return;
  std::vector<std::array<std::string, 2>> met;
  log_.whole_rows().each([&met](const FrameRow& row) { met.insert(met.end(), row.met.begin(), row.met.end()); });
  const auto meant = [this](std::size_t body) { return is_meant(bodies_[body].def, WarningKind::overlap); };
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    for (std::size_t a = 0; a < b; ++a) {
      const std::array names = {bodies_[a].def.name, bodies_[b].def.name};
      if (meant(a) || meant(b) || std::ranges::find(met, names) != met.end()) meetings_.leave_out(a, b);
    }
  }
}

// Restores the state at which an earlier run took its checkpoint: first the scene at that time, then the bodies.
void FrameLoop::resume(const Checkpoint& checkpoint) {
  const bool changed = std::ranges::any_of(
      script_.changes(), [&](const TimedChange& one) { return one.at < checkpoint.frames / scene_.fps; });
  if (changed) {
    apply(script_.scene_at(checkpoint.frames - 1), script_.changes());
    end_last_changes();
  }
  for (std::size_t b = 0; b < filmed_.size(); ++b)
    filmed_[b]->resume(checkpoint.bodies[b], log_.last_kept().bodies.at(b));
}

// In the frame of a change, positions are interpolated over the substeps, from the values in `earlier` to the new ones.
// When that frame is over, only the new ones count.
void FrameLoop::end_last_changes() {
  colliders_.earlier.clear();
  for (Body& body : bodies_) body.earlier.clear();
}

void FrameLoop::apply(SceneDef scene, const std::vector<TimedChange>& changes) {
  scene_ = std::move(scene);
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    update_body(bodies_[b], scene_, scene_.bodies[b]);
    filmed_[b]->driver().apply(cost_for(bodies_[b].def.name, changes));
  }
  CollisionSet now = collision_set(scene_);
  now.earlier = std::move(colliders_.scene_colliders);
  colliders_ = std::move(now);
  if (drawn_) drawn_->follow(changes, colliders_, bodies_);
}

Checkpoint FrameLoop::checkpoint_after(int frames) const {
  Checkpoint checkpoint{frames, {}};
  for (const auto& body : filmed_) checkpoint.bodies.push_back(body->state());
  return checkpoint;
}

void FrameLoop::keep_checkpoint_before(int frame) {
  const Zone zone("checkpoint");
  checkpoint_before_ = checkpoint_after(frame);
}

void FrameLoop::add_checkpoint(int frames) {
  const Zone zone("checkpoint");
  log_.add(checkpoint_after(frames));
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
    log_.add(checkpoint_before_);  // one at first_ is there already
  const bool at_end = result.end != FilmEnd::failed && log_.keeps_checkpoints() && !log_.wants_checkpoint(frames);
  if (at_end) add_checkpoint(frames);
  log_.settle(written_pictures());
}

}  // namespace supple
