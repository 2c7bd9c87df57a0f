#include "app/frame_loop.h"

#include <fmt/format.h>
#include <unistd.h>

#include <csignal>
#include <exception>
#include <mutex>
#include <thread>

#include "app/draw_scene.h"
#include "base/console.h"
#include "base/error.h"
#include "base/hash.h"
#include "base/queue.h"
#include "base/text.h"
#include "base/timing.h"
#include "baselines/reference.h"
#include "output/png_file.h"
#include "output/point_cache.h"
#include "output/video.h"
#include "render/renderer.h"
#include "sim/measures.h"
#include "sim/step.h"

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

// A body on its way through the film.
struct Actor {
  const Body& body;
  const Model& model;
  State state;
  FrameInputs inputs;
  Workspace workspace, reference_workspace;
  PointCacheWriter motion;
};

void add_up(BodyRow& row, const StepReport& report) {
  row.step_ms += report.step_ms;
  row.evaluate_ms += report.evaluate_ms;
  row.solve_ms += report.solve_ms;
  row.lbfgs_ms += report.lbfgs_ms;
  row.other_ms += report.other_ms;
  row.iterations += report.iterations;
  row.line_search += report.line_search;
  row.objective_start = report.objective.empty() ? 0 : report.objective.front();
  row.objective_end = report.objective.empty() ? 0 : report.objective.back();
  row.error_estimate = report.error_estimate;
  row.stop_reason = text_of(report.stop_reason);
}

std::string failure_text(int frame, const Actor& actor, const StepFailure& failure) {
  return fmt::format("frame {}: body '{}' failed while in '{}': {} (vertex {} is furthest out)", frame,
                     actor.body.def.name, failure.phase, failure.what, failure.vertex + 1);
}

// One frame's steps of one body. A message when the solver failed.
std::string advance(const SceneDef& scene, int frame, bool measure_error, Actor& actor, BodyRow& row) {
  row.name = actor.body.def.name;
  for (int substep = 0; substep < scene.substeps; ++substep) {
    const double time = (static_cast<double>(frame) * scene.substeps + substep + 1) * scene.time_step();
    handle_targets(actor.model, actor.body, time, actor.inputs.targets);
    if (actor.model.scheme.theta < 1)
      handle_targets(actor.model, actor.body, time - 0.5 * scene.time_step(), actor.inputs.middle_targets);
    const bool last = substep + 1 == scene.substeps;
    const bool measure = measure_error && last;
    const State before = measure ? actor.state : State{};
    const StepReport& report = step(actor.model, actor.inputs, actor.state, actor.workspace);
    add_up(row, report);
    if (report.failed) return failure_text(frame, actor, report.failure);
    if (measure) {
      row.error_measured = true;
      row.error = step_error(actor.model, actor.inputs, before, actor.state, actor.reference_workspace);
    }
  }
  const Deformation shape = deformation(actor.model, actor.state.x);
  row.stretch = shape.stretch;
  row.inverted = shape.inverted;
  if (scene.output.energy) {
    const Energies energy = energies(actor.model, actor.state, scene.gravity, actor.workspace);
    row.energy = {energy.kinetic, energy.elastic, energy.gravitational};
  }
  if (!actor.body.motions.empty()) {
    const double time = (frame + 1) / scene.fps;
    row.jiggle = jiggle(actor.model, actor.state.x, actor.body.motions.front().at(time));
  }
  return "";
}

}  // namespace

bool interrupted() { return interrupt_count > 0; }

void catch_interrupts() {
  struct sigaction action {};
  action.sa_handler = on_interrupt;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

FilmResult make_film(const SceneDef& scene, const std::vector<Body>& bodies, std::vector<Model>& models,
                     const RunFolder& folder, const FilmOptions& options) {
  FilmResult result;
  const Stopwatch setup;
  Threads threads(options.threads);
  std::vector<DrawnBody> drawn;
  std::optional<Pictures> pictures;
  std::vector<FrameRow> rows;
  Progress progress(scene.frames, options.quiet);
  Stopwatch loop;
  try {
    Camera camera;
    if (options.images) {
      for (const Body& body : bodies) drawn.push_back(drawn_body(scene, body));
      const Stage stage = make_stage(scene, bodies, drawn, options.font);
      camera = make_camera(scene, stage);
      pictures.emplace(stage, options, folder);
    }
    std::vector<std::unique_ptr<Actor>> actors;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      actors.push_back(
          std::make_unique<Actor>(Actor{bodies[b],
                                        models[b],
                                        start_state(models[b], bodies[b]),
                                        {scene.gravity, {}, {}, bodies[b].def.solver.settings},
                                        {},
                                        {},
                                        PointCacheWriter(folder.motion(bodies[b].def.name), models[b].vertices)}));
      actors.back()->workspace.threads = &threads;
      actors.back()->reference_workspace.threads = &threads;
    }
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
      std::vector<std::uint64_t> hashes;
      for (const auto& actor : actors) {
        row.bodies.emplace_back();
        result.message = advance(scene, frame, measure_error, *actor, row.bodies.back());
        if (!result.message.empty()) break;
        row.step_ms += row.bodies.back().step_ms;
        hashes.push_back(state_hash(actor->model, actor->state));
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
          list.positions.push_back(skin_positions(drawn[b], actors[b]->model, actors[b]->state));
        row.draw_ms = watch.elapsed_ms();
        if (!pictures->put(frame, std::move(list))) break;
      }
      for (const auto& actor : actors) actor->motion.add(in_input_order(actor->model, actor->state.x));
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
