#include "film/rough_pictures.h"

#include <fmt/core.h>

#include "film/rough_motion.h"
#include "film/rough_pass.h"
#include "output/run/row_tally.h"

namespace supple {
namespace {

constexpr PassEffort about_a_second = {120'000, true, false};

std::string pass_words(int frames, int whole) {
  if (frames == 0) return "at the start, ";
  if (frames == whole) return "in the rough first pass of the film, ";
  return fmt::format("in the rough first pass of the first {} of {} frames, ", frames, whole);
}

}  // namespace

std::vector<std::string> missing_in_rough_pictures(const FilmPlan& plan, const FilmSolvers& solvers) {
  const RoughPass pass = rough_pass(plan, solvers, about_a_second);
  if (pass.motion.empty()) return {};  // the first step failed
  DrawnFilm drawn = drawn_pass(pass);
  const SceneDef& scene = pass.film.world.scene();
  if (scene.camera.frames == Framed::film || leaves_picture(pass, drawn))
    drawn.frame_motion(outermost_points(pass, pass.film));
  RowTally tally;
  for (const FrameRow& row : rows_of(pass, drawn)) tally.add(row);
  std::vector<std::string> warnings = tally.missing_in_pictures();
  for (std::string& warning : warnings) warning = pass_words(pass.frames, scene.frames) + warning;
  return warnings;
}

}  // namespace supple
