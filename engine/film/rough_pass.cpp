#include "film/rough_pass.h"

#include <algorithm>

#include "base/interrupts.h"
#include "base/motion_hull.h"
#include "base/trace.h"
#include "film/earlier_run.h"

namespace supple {
namespace {

constexpr int quick_iterations = 4;

FilmPlan rough_plan(const FilmPlan& plan, double share) {
  FilmPlan rough = plan;
  rough.rough = share;
  rough.quiet = true;
  // The pass draws nothing that needs another run (a field's reference, a ghost) and no supports: it looks at bodies
  // alone.
  for (const char* setting : {"field.quantity=none", "field.reference=", "look.ghost=", "look.supports=false"})
    rough.settings.emplace_back(setting);
  return rough;
}

int frames_of_pass(const LoadedFilm& film, const PassEffort& effort) {
  const SceneDef& scene = film.world.script().scene();
  long long vertices = 0;
  for (const Body& body : film.world.bodies()) vertices += body.description.mesh.rest.rows();
  const long long most = effort.most_vertex_steps / std::max(1LL, vertices * scene.substeps);
  const int frames = static_cast<int>(std::min<long long>(most, scene.frames));
  for (int frame = 0; frame < frames && !effort.follows_changes; ++frame) {
    if (!film.world.script().at_work(frame).empty()) return frame;
  }
  return frames;
}

// Returns the same body, to be moved by a solver that is as quick as can be.
Body quick(Body body) {
  SolverSettings& settings = body.def.solver.settings;
  settings.iterations = std::min(settings.iterations, quick_iterations);
  settings.rounds = 1;
  settings.newton = false;
  settings.budget_ms = 0;
  body.def.solver.method = Method::quasi_newton;
  return body;
}

FramePositions positions_at_start(const World& world) {
  FramePositions positions;
  for (const Body& body : world.bodies()) positions.push_back(first_positions(body));
  return positions;
}

// Loads the scene with coarse meshes, or with its own where bodies go on from another run, which has these.
LoadedFilm film_of_pass(const FilmPlan& plan, const FilmSolvers& solvers, double share) {
  FilmPlan rough = rough_plan(plan, share);
  LoadedFilm film = load_film(rough, {});
  if (!film.world.script().scene().from) return film;
  rough.rough = 0;
  LoadedFilm whole = load_film(rough, {});
  (void)go_on_from_run(rough, solvers.steps, whole.world);
  return whole;
}

}  // namespace

RoughPass rough_pass(const FilmPlan& plan, const FilmSolvers& solvers, const PassEffort& effort) {
  const Zone zone("first pass");
  RoughPass pass{film_of_pass(plan, solvers, effort.share), {}, 0, plan.cache ? UserCache::of_user() : UserCache()};
  const World& world = pass.film.world;
  const int wanted = frames_of_pass(pass.film, effort);
  if (wanted == 0) {
    pass.motion.push_back(positions_at_start(world));
    return pass;
  }
  std::vector<Body> bodies;
  for (const Body& body : world.bodies()) bodies.push_back(effort.is_quick ? quick(body) : body);
  World rough(world.script().with({}), std::move(bodies));
  Threads threads(effort.is_quick ? 1 : pass.film.info.threads);
  rough.start(solvers.steps, &threads);
  while (pass.frames < wanted && !interrupted() && rough.play(pass.frames)) {
    pass.motion.emplace_back();
    for (std::size_t b = 0; b < rough.size(); ++b)
      pass.motion.back().push_back(in_input_order(rough.body(b).model(), rough.body(b).state().x));
    ++pass.frames;
  }
  return pass;
}

DrawnFilm drawn_pass(const RoughPass& pass) {
  const World& world = pass.film.world;
  return {world.script(), world.bodies(), drawn_bodies(world.bodies(), {}, DrawnAs::elements), world.colliders(), {}};
}

std::vector<FrameRow> rows_of(const RoughPass& pass, DrawnFilm& drawn) {
  const World& world = pass.film.world;
  Threads threads(1);
  std::vector<FrameRow> rows;
  for (int frame = 0; frame < static_cast<int>(pass.motion.size()); ++frame) {
    FramePose pose{frame, world.scene().time_after(frame), {}, {}};
    for (const Positions& body : pass.motion[std::size_t(frame)]) pose.motion.push_back(&body);
    const DrawList list = drawn.list(world.scene(), pose, world.colliders(), threads);
    FrameRow& row = rows.emplace_back();
    row.frame = frame;
    for (std::size_t b = 0; b < world.size(); ++b) {
      row.bodies.emplace_back().name = world.bodies()[b].def.name;
      row.bodies.back().in_picture = drawn.share_in_picture(b, list);
    }
  }
  return rows;
}

namespace {

// Keeps points of a skin that are spread over it, as many as show where it goes.
Embedding thinned(Embedding skin) {
  constexpr Eigen::Index enough = 2000;
  const Eigen::Index every = 1 + skin.points() / enough;
  std::vector<std::int32_t> kept;
  for (Eigen::Index point = 0; point < skin.points(); point += every) kept.push_back(static_cast<std::int32_t>(point));
  keep_points(skin, kept);
  return skin;
}

}  // namespace

std::vector<Vec3> outermost_points(const RoughPass& pass, const LoadedFilm& whole) {
  constexpr double air = 0.02;  // over the diagonal, because finer bodies move a little differently
  MotionHull hull;
  // Coarse elements reach far beyond thin parts, so that it is the skin on them that tells what will be seen.
  const std::vector<Body>& bodies = pass.film.world.bodies();
  const std::vector<DrawnBody> drawn = drawn_bodies(bodies, {pass.cache, {}});
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const bool is_mesh = !drawn[b].vertex_of.empty();
    const Embedding skin = is_mesh ? Embedding() : thinned(drawn[b].embedding);
    for (const FramePositions& frame : pass.motion) hull.include(is_mesh ? frame[b] : embedded_points(skin, frame[b]));
  }
  // Coarse bodies may lack the tips of ears and tails, so the real bodies at rest are there too.
  for (std::size_t b = 0; b < whole.world.bodies().size(); ++b) {
    const bool has_skin = b < whole.drawn.size() && whole.drawn[b].skin.rest.points.rows() > 0;
    hull.include(has_skin ? whole.drawn[b].skin.rest.points : whole.world.bodies()[b].description.mesh.rest);
  }
  std::vector<Vec3> points = hull.points();
  const Bounds box = box_around(points);
  for (Vec3& point : points) point += air * box.diagonal() * (point - box.center()).stableNormalized();
  return points;
}

}  // namespace supple
