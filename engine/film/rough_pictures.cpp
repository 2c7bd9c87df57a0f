#include "film/rough_pictures.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/frame_time.h"
#include "film/film.h"
#include "film/pictures/drawn_film.h"
#include "output/run/row_tally.h"

namespace supple {
namespace {

constexpr int most_vertex_steps = 120'000;  // over all bodies, frames and substeps: about a second
constexpr int rough_iterations = 4;

FilmPlan rough_plan(const FilmPlan& plan) {
  FilmPlan rough = plan;
  rough.rough = rough.quiet = true;
  // The pass draws nothing that needs another run (a field's reference, a ghost) and no supports: it looks at bodies
  // alone.
  for (const char* setting : {"field.quantity=none", "field.reference=", "look.ghost=", "look.supports=false"})
    rough.settings.emplace_back(setting);
  return rough;
}

// Returns how many frames the first pass makes: none with changes of a replay, and none at all where a single one would
// take too long.
int frames_of_pass(const LoadedFilm& film) {
  const SceneDef& scene = film.script.scene();
  long long vertices = 0;
  for (const Body& body : film.bodies) vertices += body.description.mesh.rest.rows();
  const long long most = most_vertex_steps / std::max(1LL, vertices * scene.substeps);
  const int frames = static_cast<int>(std::min<long long>(most, scene.frames));
  for (int frame = 0; frame < frames; ++frame) {
    if (!film.script.at_work(frame).empty()) return frame;
  }
  return frames;
}

// Makes the frames of one body, and returns its positions after each, by vertex of its mesh [m]. Where a step fails,
// there are no more.
std::vector<Positions> rough_motion_of(const SceneDef& scene, Body& body, const CollisionSet& set,
                                       const FilmSolvers& solvers, Threads& threads, int frames) {
  SolverSettings& settings = body.def.solver.settings;
  settings.iterations = std::min(settings.iterations, rough_iterations);
  settings.rounds = 1;
  settings.newton = false;
  settings.budget_ms = 0;
  body.def.solver.method = Method::quasi_newton;
  Model model = build_model(body.description);
  DrivenBody driver(scene, body, model, set, solvers.steps, &threads);
  std::vector<Positions> motion;
  for (int frame = 0; frame < frames; ++frame) {
    if (driver.make_frame(frame, [](const StepReport&) {}).failed) break;
    motion.push_back(in_input_order(model, driver.state().x));
  }
  return motion;
}

Bounds box_around(const std::vector<std::vector<Positions>>& motion, const std::vector<Body>& bodies) {
  Bounds box = bounds_at_rest(bodies);
  for (const std::vector<Positions>& body : motion) {
    for (const Positions& frame : body) {
      box.include(bounds_of(frame).lower);
      box.include(bounds_of(frame).upper);
    }
  }
  return box;
}

std::string pass_words(int frames, int whole) {
  if (frames == 0) return "at the start, ";
  if (frames == whole) return "in the rough first pass of the film, ";
  return fmt::format("in the rough first pass of the first {} of {} frames, ", frames, whole);
}

}  // namespace

std::vector<std::string> missing_in_rough_pictures(const FilmPlan& plan, const FilmSolvers& solvers) {
  LoadedFilm film = load_film(rough_plan(plan), {});
  const SceneDef& scene = film.script.scene();
  const CollisionSet set = collision_set(scene);
  Threads threads(1);
  int frames = frames_of_pass(film);
  std::vector<std::vector<Positions>> motion;
  for (Body& body : film.bodies) {
    if (frames == 0) {
      motion.push_back({first_positions(body)});
      continue;
    }
    motion.push_back(rough_motion_of(scene, body, set, solvers, threads, frames));
    frames = static_cast<int>(motion.back().size());
    if (frames == 0) return {};  // its first step failed
  }
  DrawnFilm drawn(film.script, film.bodies, drawn_bodies(film.bodies, {}, DrawnAs::elements), set, "");
  if (scene.camera.frames == Framed::film) drawn.frame_motion(box_around(motion, film.bodies));
  RowTally tally;
  for (int frame = 0; frame < std::max(1, frames); ++frame) {
    FramePose pose{frame, frame_time(frame, scene.fps), {}, {}};
    for (const std::vector<Positions>& body : motion) pose.motion.push_back(&body[std::size_t(frame)]);
    const DrawList list = drawn.list(scene, pose, set, threads);
    FrameRow row;
    row.frame = frame;
    for (std::size_t b = 0; b < film.bodies.size(); ++b) {
      row.bodies.emplace_back().name = film.bodies[b].def.name;
      row.bodies.back().in_picture = drawn.share_in_picture(b, list);
    }
    tally.add(row);
  }
  std::vector<std::string> warnings = tally.missing_in_pictures();
  for (std::string& warning : warnings) warning = pass_words(frames, scene.frames) + warning;
  return warnings;
}

}  // namespace supple
