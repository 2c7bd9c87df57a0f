#include "film/rough_pictures.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/frame_time.h"
#include "film/pictures/drawn_film.h"
#include "film/plan/loaded_film.h"
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

// Returns how many frames the first pass makes: only those before a replay's first change, and none where a single one
// would take too long.
int frames_of_pass(const LoadedFilm& film) {
  const SceneDef& scene = film.world.script().scene();
  long long vertices = 0;
  for (const Body& body : film.world.bodies()) vertices += body.description.mesh.rest.rows();
  const long long most = most_vertex_steps / std::max(1LL, vertices * scene.substeps);
  const int frames = static_cast<int>(std::min<long long>(most, scene.frames));
  for (int frame = 0; frame < frames; ++frame) {
    if (!film.world.script().at_work(frame).empty()) return frame;
  }
  return frames;
}

// Returns the same body, to be moved by a solver that is as quick as can be.
Body quick(Body body) {
  SolverSettings& settings = body.def.solver.settings;
  settings.iterations = std::min(settings.iterations, rough_iterations);
  settings.rounds = 1;
  settings.newton = false;
  settings.budget_ms = 0;
  body.def.solver.method = Method::quasi_newton;
  return body;
}

using FramePositions = std::vector<Positions>;  // by body: the positions of its mesh, n x 3 [m]

FramePositions positions_at_start(const World& world) {
  FramePositions positions;
  for (const Body& body : world.bodies()) positions.push_back(first_positions(body));
  return positions;
}

// Plays the first frames of a scene. Returns the positions after each frame, up to the first frame that fails.
std::vector<FramePositions> rough_motion_of(const World& world, const FilmSolvers& solvers, Threads& threads,
                                            int frames) {
  std::vector<Body> bodies;
  for (const Body& body : world.bodies()) bodies.push_back(quick(body));
  World rough(world.scene(), std::move(bodies));
  rough.start(solvers.steps, &threads);
  std::vector<FramePositions> motion;
  for (int frame = 0; frame < frames && rough.play(frame); ++frame) {
    motion.emplace_back();
    for (std::size_t b = 0; b < rough.size(); ++b)
      motion.back().push_back(in_input_order(rough.body(b).model(), rough.body(b).state().x));
  }
  return motion;
}

Bounds box_around(const std::vector<FramePositions>& motion, const std::vector<Body>& bodies) {
  Bounds box = bounds_at_rest(bodies);
  for (const FramePositions& frame : motion) {
    for (const Positions& body : frame) {
      box.include(bounds_of(body).lower);
      box.include(bounds_of(body).upper);
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
  const LoadedFilm film = load_film(rough_plan(plan), {});
  const World& world = film.world;
  const SceneDef& scene = world.scene();
  Threads threads(1);
  const int wanted = frames_of_pass(film);
  const std::vector<FramePositions> motion = wanted > 0 ? rough_motion_of(world, solvers, threads, wanted)
                                                        : std::vector<FramePositions>{positions_at_start(world)};
  if (motion.empty()) return {};  // the first step failed
  const int frames = std::min(wanted, int(motion.size()));
  DrawnFilm drawn(world.script(), world.bodies(), drawn_bodies(world.bodies(), {}, DrawnAs::elements),
                  world.colliders(), "");
  if (scene.camera.frames == Framed::film) drawn.frame_motion(box_around(motion, world.bodies()));
  RowTally tally;
  for (int frame = 0; frame < std::max(1, frames); ++frame) {
    FramePose pose{frame, frame_time(frame, scene.fps), {}, {}};
    for (const Positions& body : motion[std::size_t(frame)]) pose.motion.push_back(&body);
    const DrawList list = drawn.list(scene, pose, world.colliders(), threads);
    FrameRow row;
    row.frame = frame;
    for (std::size_t b = 0; b < world.size(); ++b) {
      row.bodies.emplace_back().name = world.bodies()[b].def.name;
      row.bodies.back().in_picture = drawn.share_in_picture(b, list);
    }
    tally.add(row);
  }
  std::vector<std::string> warnings = tally.missing_in_pictures();
  for (std::string& warning : warnings) warning = pass_words(frames, scene.frames) + warning;
  return warnings;
}

}  // namespace supple
