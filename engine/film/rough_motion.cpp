#include "film/rough_motion.h"

#include <fmt/core.h>

#include <algorithm>
#include <limits>

#include "base/timing.h"
#include "output/run/run_record.h"

namespace supple {
namespace {

constexpr PassEffort few_seconds = {400'000, true, true};

// Returns the effort for a whole film. Bodies of the coarsest meshes roll and bounce elsewhere than the film's own, so
// the pass has meshes that are as fine as it can play in about a second.
PassEffort whole_film(const World& world) {
  constexpr double vertex_steps = 120'000;
  constexpr double nearly_all = 0.5;  // of the vertices: the film's own meshes then cost little more, and are made
  PassEffort effort{std::numeric_limits<long long>::max(), false, true};
  double steps = 0;
  for (const Body& body : world.bodies())
    steps += static_cast<double>(body.description.mesh.rest.rows()) * world.scene().frames * world.scene().substeps;
  const double share = vertex_steps / std::max(1.0, steps);
  effort.share = share < nearly_all ? std::max(effort.share, share) : 1;
  return effort;
}

bool changes_camera_at_all(const Script& script) {
  for (int frame = 0; frame < script.scene().frames; ++frame) {
    for (const TimedChange* change : script.at_work(frame))
      if (change->path.starts_with("camera")) return true;
  }
  return false;
}

// Tells whether the program decides what the camera frames.
bool is_left_open(const Script& script) {
  const CameraDef& camera = script.scene().camera;
  return camera.frames == Framed::automatic && !camera.is_placed() && !changes_camera_at_all(script);
}

std::string frames_text(const RoughPass& pass) {
  const int whole = pass.film.world.scene().frames;
  return pass.frames == whole ? fmt::format("all {} frames", whole)
                              : fmt::format("{} of {} frames", pass.frames, whole);
}

}  // namespace

bool leaves_picture(const RoughPass& pass, DrawnFilm& drawn) {
  if (!is_left_open(pass.film.world.script())) return false;
  const auto is_cut = [](const BodyRow& body) { return body.in_picture && *body.in_picture < 1; };
  return std::ranges::any_of(rows_of(pass, drawn),
                             [&](const FrameRow& row) { return std::ranges::any_of(row.bodies, is_cut); });
}

std::string find_framing(const FilmPlan& plan, const FilmStart& start, const FilmSolvers& solvers, LoadedFilm& film) {
  const Script& script = film.world.script();
  const bool asked = wants_motion(script.scene()), open = is_left_open(script);
  if (plan.pictures == FilmPictures::none || (!asked && !open)) return "";
  if (start.kept_frames() > 0) {
    film.info.framed = framed_in(read_run(start.place.path).info_json);
    if (!asked || !film.info.framed.empty()) return "";
  }
  const Stopwatch watch;
  const RoughPass pass = rough_pass(plan, solvers, asked ? whole_film(film.world) : few_seconds);
  if (pass.motion.empty()) return "";  // the film itself will say why its first step fails
  if (!asked) {
    DrawnFilm drawn = drawn_pass(pass);
    if (!leaves_picture(pass, drawn)) return "";
  }
  film.info.framed = outermost_points(pass, film);
  return fmt::format("the camera shows the bodies' whole motion{}: a rough first pass of {} found it in {:.1f} s\n",
                     asked ? "" : ", which leaves the picture of the start", frames_text(pass),
                     watch.elapsed_ms() / 1000);
}

}  // namespace supple
