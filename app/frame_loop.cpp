#include "app/frame_loop.h"

#include <fmt/core.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <exception>
#include <utility>

#include "app/actor.h"
#include "app/draw_scene.h"
#include "app/film_log.h"
#include "app/pictures.h"
#include "app/progress.h"
#include "base/error.h"
#include "base/hash.h"
#include "base/timing.h"
#include "base/trace.h"
#include "output/pose_table.h"
#include "output/video.h"

namespace supple {
namespace {

volatile std::sig_atomic_t interrupt_count = 0;

extern "C" void on_interrupt(int signal) {
  if (signal == SIGHUP && interrupt_count > 0) return;  // system and shell may both tell that the terminal is gone
  interrupt_count = interrupt_count + 1;
  if (interrupt_count >= 3) _exit(130);  // somebody means it
}

}  // namespace

bool interrupted() { return interrupt_count > 0; }

void catch_interrupts() {
  struct sigaction action {};
  action.sa_handler = on_interrupt;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  struct sigaction before {};
  sigaction(SIGHUP, nullptr, &before);
  if (before.sa_handler != SIG_IGN) sigaction(SIGHUP, &action, nullptr);  // nohup ignores it
}

namespace {

// What is drawn, which follows from the scene as the film starts; only with images.
struct DrawnFilm {
  DrawnFilm(const SceneDef& scene, const std::vector<Body>& bodies, const CollisionSet& set, const std::string& font) {
    for (const Body& body : bodies) drawn.push_back(drawn_body(scene, body));
    film_set = drawn_set(set.obstacles, bodies);
    stage = make_stage(scene, bodies, drawn, set.obstacles, film_set, font);
  }

  // The shape of a collider has changed.
  void renew(std::size_t collider, const CollisionSet& set, const std::vector<Body>& bodies) {
    film_set[collider] = drawn_obstacle(set.obstacles[collider], bounds_at_rest(bodies));
    renewed.push_back(collider);
  }

  DrawList list(const SceneDef& scene, const std::vector<std::unique_ptr<Actor>>& actors, const CollisionSet& set,
                double time) {
    DrawList result;
    result.camera = make_camera(scene, stage);
    for (std::size_t b = 0; b < actors.size(); ++b)
      result.positions.push_back(skin_positions(drawn[b], actors[b]->model(), actors[b]->state()));
    add_set(set.obstacles, film_set, time, result);
    for (const std::size_t c : std::exchange(renewed, {}))
      result.renewed.emplace_back(actors.size() + c, collider_mesh(set.obstacles[c], film_set[c]));
    for (std::size_t b = 0; b < actors.size(); ++b) {
      if (stage.meshes[b].label == scene.bodies[b].label) continue;
      stage.meshes[b].label = scene.bodies[b].label;
      result.captions.emplace_back(b, scene.bodies[b].label);
    }
    return result;
  }

  std::vector<DrawnBody> drawn;
  std::vector<Skin> film_set;  // of colliders
  Stage stage;
  std::vector<std::size_t> renewed;  // colliders, since the last list
};

// A film in progress.
class Film {
 public:
  Film(const Script& script, std::vector<Body>& bodies, std::vector<Model>& models, const RunFolder& folder,
       const FilmOptions& options, FilmLog& log)
      : script_(script),
        bodies_(bodies),
        folder_(folder),
        options_(options),
        scene_(script.scene()),
        set_(collision_set(scene_)),
        threads_(options.threads),
        start_(options.start ? options.start->frames : 0),
        log_(log) {
    if (options.images) {
      drawn_.emplace(scene_, bodies, set_, options.font);
      pictures_.emplace(drawn_->stage, options.gl, options.shaders, folder);
    }
    for (std::size_t b = 0; b < bodies.size(); ++b)
      actors_.push_back(std::make_unique<Actor>(scene_, bodies[b], models[b], set_, folder, threads_, start_));
    if (!set_.obstacles.empty()) poses_.emplace(folder.colliders(), start_ * int(set_.obstacles.size()));
    if (options.start) go_on();
    if (!options.record.empty()) recorder_.emplace(options.record, options.record_head, start_);
  }

  // Returns how it ended.
  FilmEnd run(Progress& progress, std::string& message) {
    for (int frame = start_; frame < script_.scene().frames; ++frame) {
      if (interrupted()) return FilmEnd::interrupted;
      const Zone zone("frame", {}, frame);
      FrameRow row;
      row.frame = frame;
      row.time_s = (frame + 1) / scene_.fps;
      if (log_.keeps_checkpoints()) remember(frame);
      change(frame, row);
      message = advance(frame, row);
      if (!message.empty()) return FilmEnd::failed;
      for (const auto& actor : actors_) actor->save_motion();
      if (options_.fields_every > 0 && frame % options_.fields_every == 0) {
        for (const auto& actor : actors_) actor->save_fields(frame);
      }
      for (const Obstacle& obstacle : set_.obstacles) poses_->add(frame, obstacle.def.name, obstacle.pose(row.time_s));
      if (!show(frame, row)) return FilmEnd::failed;  // the pictures' error says why
      log_.add(std::move(row));
      if (log_.wants_checkpoint(frame + 1)) add_checkpoint(frame + 1);
      log_.settle(pictures());
      progress.show(frame + 1);
    }
    return FilmEnd::done;
  }

  // Waits for the pictures, and leaves a checkpoint behind the last frame.
  void finish(FilmResult& result) {
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
    const int frames = static_cast<int>(log_.rows().size());
    // Of a film that failed, the bodies may be in the middle of a frame.
    if (result.end == FilmEnd::failed && before_.frames > start_) log_.add(before_);
    const bool at_end = result.end != FilmEnd::failed && log_.keeps_checkpoints() && !log_.wants_checkpoint(frames);
    if (at_end) add_checkpoint(frames);
    log_.settle(pictures());
  }

 private:
  Pictures* pictures() { return pictures_ ? &*pictures_ : nullptr; }

  // To where an earlier run's checkpoint was taken.
  void go_on() {
    const int before = start_ - 1;
    const bool changed = std::ranges::any_of(
        script_.changes(), [&](const TimedChange& change) { return change.at < start_ / scene_.fps; });
    if (changed) {
      take_over(script_.scene_at(before), script_.changes());
      settle_changes();
    }
    for (std::size_t b = 0; b < actors_.size(); ++b) actors_[b]->go_on_from(options_.start->bodies[b]);
  }

  // What a replay changes in a frame.
  void change(int frame, FrameRow& row) {
    settle_changes();
    const std::vector<const TimedChange*> at_work = script_.at_work(frame);
    if (at_work.empty()) return;
    const Zone zone("change");
    const Stopwatch watch;
    std::vector<TimedChange> changes;
    for (const TimedChange* one : at_work) changes.push_back(*one);
    take_over(script_.scene_at(frame), changes);
    row.change_ms = watch.elapsed_ms();
  }

  void settle_changes() {
    set_.earlier.clear();
    for (Body& body : bodies_) body.earlier.clear();
  }

  void take_over(SceneDef scene, const std::vector<TimedChange>& changes) {
    const auto cost_for = [&changes](const std::string& name) {
      ChangeCost cost;
      for (const TimedChange& change : changes) {
        if (change.object.empty() || change.object == name) cost |= change.cost;
      }
      return cost;
    };
    scene_ = std::move(scene);
    for (std::size_t b = 0; b < bodies_.size(); ++b) {
      update_body(bodies_[b], scene_, scene_.bodies[b]);
      actors_[b]->adopt(cost_for(bodies_[b].def.name));
    }
    CollisionSet now = collision_set(scene_);
    now.earlier = std::move(set_.obstacles);
    set_ = std::move(now);
    for (std::size_t c = 0; drawn_ && c < set_.obstacles.size(); ++c) {
      const std::string& name = set_.obstacles[c].def.name;
      // What is drawn of a half space depends on where it is.
      const bool moved =
          is_half_space(set_.obstacles[c]) &&
          std::ranges::any_of(changes, [&name](const TimedChange& change) { return change.object == name; });
      if (moved || cost_for(name).surface) drawn_->renew(c, set_, bodies_);
    }
  }

  // All bodies' steps. Returns what went wrong.
  std::string advance(int frame, FrameRow& row) {
    const bool measure_error = options_.error_every > 0 && frame % options_.error_every == 0;
    const bool save_states = std::ranges::find(options_.save_states, frame) != options_.save_states.end();
    std::vector<std::uint64_t> hashes;
    for (const auto& actor : actors_) {
      if (save_states) actor->save_state(frame);
      row.bodies.emplace_back();
      std::string message = actor->advance(frame, measure_error, row.bodies.back());
      if (!message.empty()) return message;
      row.step_ms += row.bodies.back().step_ms;
      hashes.push_back(state_hash(actor->model(), actor->state()));
      if (options_.verifier != nullptr) message = options_.verifier->compare(frame, actor->model(), actor->state());
      if (!message.empty()) return message;
    }
    for (const auto& actor : actors_) {  // a record has whole frames
      if (recorder_) recorder_->add(actor->model(), actor->state());
    }
    // Of one body its own; of several, XXH64 of theirs in the order of the scene.
    row.state_hash =
        hashes.size() == 1 ? hashes.front() : hash_bytes(hashes.data(), sizeof(hashes.front()) * hashes.size());
    return "";
  }

  // False when the pictures have failed.
  bool show(int frame, FrameRow& row) {
    const bool drawn = options_.pictured.empty() || std::ranges::count(options_.pictured, frame) > 0;
    if (!pictures_ || !drawn) return true;
    Zone zone("draw list");
    const Stopwatch watch;
    DrawList list = drawn_->list(scene_, actors_, set_, row.time_s);
    row.draw_ms = watch.elapsed_ms();
    zone.next("wait for render");
    return pictures_->put(frame, std::move(list));
  }

  void add_checkpoint(int frames) {
    const Zone zone("checkpoint");
    log_.add(moment_behind(frames));
  }

  // In case that the frame fails.
  void remember(int frame) {
    const Zone zone("checkpoint");
    before_ = moment_behind(frame);
  }

  Checkpoint moment_behind(int frames) const {
    Checkpoint checkpoint{frames, {}};
    for (const auto& actor : actors_) checkpoint.bodies.push_back(actor->moment());
    return checkpoint;
  }

  const Script& script_;
  std::vector<Body>& bodies_;
  const RunFolder& folder_;
  const FilmOptions& options_;
  SceneDef scene_;  // of the frame in progress
  CollisionSet set_;
  Threads threads_;
  int start_;
  FilmLog& log_;
  Checkpoint before_;  // the frame in progress
  std::optional<DrawnFilm> drawn_;
  std::vector<std::unique_ptr<Actor>> actors_;
  std::optional<PoseTableWriter> poses_;
  std::optional<StateRecorder> recorder_;
  std::optional<Pictures> pictures_;  // last: its threads end first
};

}  // namespace

FilmResult make_film(const Script& script, std::vector<Body>& bodies, std::vector<Model>& models,
                     const RunFolder& folder, const FilmOptions& options) {
  FilmResult result;
  const Stopwatch setup;
  Stopwatch loop;
  const int start = result.kept_frames = options.start ? options.start->frames : 0;
  Progress progress(script.scene().frames, start, options.quiet);
  std::optional<FilmLog> log;
  std::optional<Film> film;
  try {
    Zone prepare("prepare film");
    log.emplace(folder, options.checkpoint_every, options.identity, start);
    film.emplace(script, bodies, models, folder, options, *log);
    result.setup_ms = setup.elapsed_ms();
    loop.lap_ms();
    prepare.finish();
    result.end = film->run(progress, result.message);
  } catch (const std::exception& error) {
    result.end = FilmEnd::failed;
    result.message = error.what();
  }
  if (film) {
    try {
      film->finish(result);
    } catch (const std::exception& error) {
      result.end = FilmEnd::failed;
      if (result.message.empty()) result.message = error.what();
    }
  }
  if (log) {
    log->drop_others();
    result.rows = log->rows();
  }
  progress.end();
  result.wall_ms = loop.elapsed_ms();
  if (film && options.images && options.video && !result.rows.empty()) {
    const Zone zone("video");
    const VideoResult video =
        encode_video(folder.frames(), static_cast<int>(result.rows.size()), script.scene().fps, folder.video());
    result.video_written = video.outcome == VideoOutcome::written;
    result.video_failed = video.outcome == VideoOutcome::failed;
    result.video_message = video.message;
  }
  return result;
}

}  // namespace supple
