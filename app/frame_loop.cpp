#include "app/frame_loop.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <exception>
#include <mutex>
#include <thread>

#include "app/actor.h"
#include "app/draw_scene.h"
#include "base/console.h"
#include "base/error.h"
#include "base/hash.h"
#include "base/queue.h"
#include "base/text.h"
#include "base/timing.h"
#include "output/png_file.h"
#include "output/pose_table.h"
#include "output/video.h"
#include "render/renderer.h"

namespace supple {
namespace {

volatile std::sig_atomic_t interrupt_count = 0;

extern "C" void on_interrupt(int) {
  interrupt_count = interrupt_count + 1;
  if (interrupt_count >= 3) _exit(130);  // somebody means it
}

constexpr std::size_t frames_in_flight = 3;  // between two stages

// Drawing and compressing, each on a thread of its own. A stage that fails closes the queues; its error waits to be
// collected.
class Pictures {
 public:
  Pictures(const Stage& stage, const FilmOptions& options, const RunFolder& folder)
      : options_(options), folder_(folder), lists_(frames_in_flight), images_(frames_in_flight) {
    drawing_ = std::thread([this, stage] { guarded([&] { draw_all(stage); }); });
    compressing_ = std::thread([this] { guarded([this] { compress_all(); }); });
  }
  ~Pictures() { finish(); }

  // False when a stage has failed.
  bool put(int frame, DrawList list) { return lists_.push({frame, std::move(list)}); }

  // Waits until every frame that was put is on the disk.
  void finish() {
    lists_.close();
    if (drawing_.joinable()) drawing_.join();
    images_.close();
    if (compressing_.joinable()) compressing_.join();
  }

  std::string error() {
    const std::lock_guard lock(mutex_);
    return error_;
  }
  // Valid after finish().
  const std::vector<std::pair<double, double>>& times() const { return times_; }  // render and encode by frame [ms]
  int frames_written() const { return frames_written_; }
  std::string backend, renderer, version;

 private:
  template <class Work>
  void guarded(const Work& work) {
    try {
      work();
    } catch (const std::exception& error) {
      const std::lock_guard lock(mutex_);
      if (error_.empty()) error_ = error.what();
    }
    lists_.close();
    images_.close();
  }

  void draw_all(const Stage& stage) {
    Renderer renderer_object(stage, options_.gl, options_.shaders);
    backend = renderer_object.backend();
    renderer = renderer_object.name();
    version = renderer_object.version();
    while (auto item = lists_.pop()) {
      const Stopwatch watch;
      Image image = renderer_object.draw(item->second);
      const double ms = watch.elapsed_ms();
      if (!images_.push({item->first, ms, std::move(image)})) return;
    }
  }

  struct Drawn {
    int frame;
    double render_ms;
    Image image;
  };

  void compress_all() {
    while (auto drawn = images_.pop()) {
      const Stopwatch watch;
      write_png(folder_.frame(drawn->frame), drawn->image.width, drawn->image.height, drawn->image.rgb);
      times_.emplace_back(drawn->render_ms, watch.elapsed_ms());
      frames_written_ = drawn->frame + 1;
    }
  }

  const FilmOptions& options_;
  const RunFolder& folder_;
  BoundedQueue<std::pair<int, DrawList>> lists_;
  BoundedQueue<Drawn> images_;
  std::thread drawing_, compressing_;
  std::mutex mutex_;
  std::string error_;
  std::vector<std::pair<double, double>> times_;
  int frames_written_ = 0;
};

// The progress line on a terminal; a plain line now and then elsewhere.
class Progress {
 public:
  Progress(int frames, bool quiet) : frames_(frames), quiet_(quiet), terminal_(isatty(STDERR_FILENO) == 1) {}

  void show(int done) {
    const double elapsed = watch_.elapsed_ms() / 1000;
    const bool due = terminal_ ? elapsed - last_ > 0.1 : elapsed - last_ > 10;
    if (quiet_ || (!due && done != frames_)) return;
    last_ = elapsed;
    const std::string left = duration_text(elapsed / done * (frames_ - done));
    say(stderr, fmt::format("{}frame {} of {}, {:.1f} a second, {} left{}", terminal_ ? "\r\033[K" : "", done, frames_,
                            done / elapsed, left, terminal_ ? "" : "\n"));
    shown_ = true;
  }
  void end() {
    if (!quiet_ && terminal_ && shown_) say(stderr, fmt::format("\n"));
  }

 private:
  int frames_;
  bool quiet_, terminal_, shown_ = false;
  double last_ = 0;
  Stopwatch watch_;
};

}  // namespace

bool interrupted() { return interrupt_count > 0; }

void catch_interrupts() {
  struct sigaction action {};
  action.sa_handler = on_interrupt;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

FilmResult make_film(const SceneDef& scene, const std::vector<Body>& bodies, std::vector<Model>& models,
                     const CollisionSet& set, const RunFolder& folder, const FilmOptions& options) {
  FilmResult result;
  const Stopwatch setup;
  Threads threads(options.threads);
  std::vector<DrawnBody> drawn;
  std::vector<Skin> film_set;  // of colliders
  std::optional<Pictures> pictures;
  std::vector<FrameRow> rows;
  Progress progress(scene.frames, options.quiet);
  Stopwatch loop;
  try {
    Camera camera;
    if (options.images) {
      for (const Body& body : bodies) drawn.push_back(drawn_body(scene, body));
      film_set = drawn_set(set.obstacles, bodies);
      const Stage stage = make_stage(scene, bodies, drawn, set.obstacles, film_set, options.font);
      camera = make_camera(scene, stage);
      pictures.emplace(stage, options, folder);
    }
    std::vector<std::unique_ptr<Actor>> actors;
    for (std::size_t b = 0; b < bodies.size(); ++b)
      actors.push_back(std::make_unique<Actor>(scene, bodies[b], models[b], set, folder, threads));
    std::optional<PoseTableWriter> poses;
    if (!set.obstacles.empty()) poses.emplace(folder.colliders());
    result.setup_ms = setup.elapsed_ms();
    loop.lap_ms();
    for (int frame = 0; frame < scene.frames; ++frame) {
      if (interrupted()) {
        result.end = FilmEnd::interrupted;
        break;
      }
      FrameRow row;
      row.frame = frame;
      row.time_s = (frame + 1) / scene.fps;
      const bool measure_error = options.error_every > 0 && frame % options.error_every == 0;
      const bool save_states = std::ranges::find(options.save_states, frame) != options.save_states.end();
      std::vector<std::uint64_t> hashes;
      for (const auto& actor : actors) {
        if (save_states) actor->save_state(frame);
        row.bodies.emplace_back();
        result.message = actor->advance(frame, measure_error, row.bodies.back());
        if (!result.message.empty()) break;
        row.step_ms += row.bodies.back().step_ms;
        hashes.push_back(state_hash(actor->model(), actor->state()));
      }
      if (!result.message.empty()) {
        result.end = FilmEnd::failed;
        break;
      }
      // Of one body its own; of several, XXH64 of theirs in the order of the scene.
      row.state_hash =
          hashes.size() == 1 ? hashes.front() : hash_bytes(hashes.data(), sizeof(hashes.front()) * hashes.size());
      if (pictures) {
        const Stopwatch watch;
        DrawList list{camera, {}};
        for (std::size_t b = 0; b < actors.size(); ++b)
          list.positions.push_back(skin_positions(drawn[b], actors[b]->model(), actors[b]->state()));
        add_set(set.obstacles, film_set, row.time_s, list);
        row.draw_ms = watch.elapsed_ms();
        if (!pictures->put(frame, std::move(list))) break;
      }
      for (const auto& actor : actors) actor->save_motion();
      for (const Obstacle& obstacle : set.obstacles) poses->add(frame, obstacle.def.name, obstacle.pose(row.time_s));
      rows.push_back(std::move(row));
      progress.show(frame + 1);
    }
  } catch (const std::exception& error) {
    result.end = FilmEnd::failed;
    result.message = error.what();
  }
  if (pictures) {
    pictures->finish();
    for (std::size_t i = 0; i < rows.size() && i < pictures->times().size(); ++i) {
      rows[i].render_ms = pictures->times()[i].first;
      rows[i].encode_ms = pictures->times()[i].second;
    }
    if (!pictures->error().empty()) {
      result.end = FilmEnd::failed;
      result.message = pictures->error();
      rows.resize(std::min<std::size_t>(rows.size(), pictures->frames_written()));
    }
    result.gl_backend = pictures->backend;
    result.gl_renderer = pictures->renderer;
    result.gl_version = pictures->version;
  }
  progress.end();
  result.wall_ms = loop.elapsed_ms();
  result.rows = std::move(rows);
  if (pictures && options.video && !result.rows.empty()) {
    const VideoResult video =
        encode_video(folder.frames(), static_cast<int>(result.rows.size()), scene.fps, folder.video());
    result.video_written = video.outcome == VideoOutcome::written;
    result.video_failed = video.outcome == VideoOutcome::failed;
    result.video_message = video.message;
  }
  return result;
}

}  // namespace supple
