#include "film/rough_motion.h"

#include <fmt/core.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>

#include "base/error.h"
#include "output/files/obj_file.h"
#include "output/motion/point_cache.h"
#include "output/run/run_record.h"

namespace supple {
namespace {

constexpr double air = 0.02;  // room around the box, over its diagonal, because finer bodies move a little differently

class ScratchFolder {
 public:
  ScratchFolder() {
    const char* given = std::getenv("TMPDIR");
    const std::filesystem::path place = given != nullptr && *given != '\0' ? given : "/tmp";
    std::string name = (place / "supple-first-pass-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr)
      throw RunError(
          fmt::format("{}: the camera's first pass cannot make a folder there: {}; set TMPDIR to a folder "
                      "that can be written",
                      place.string(), std::strerror(errno)));
    path = name;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  std::filesystem::path path;
};

// Returns the plan of the first pass: the same film, coarse, without pictures and without anything that is asked for
// beside them.
FilmPlan first_pass(const FilmPlan& plan, const std::filesystem::path& folder) {
  FilmPlan rough;
  rough.scene = plan.scene;
  rough.scene_text = plan.scene_text;
  rough.sweep_point = plan.sweep_point;
  rough.settings = plan.settings;
  rough.frames = plan.frames;
  rough.seed = plan.seed;
  rough.threads = plan.threads;
  rough.cache = plan.cache;
  rough.out = folder.string();
  rough.rough = rough.force = rough.quiet = true;
  rough.pictures = FilmPictures::none;
  rough.video = false;
  rough.checkpoint_every = 0;
  return rough;
}

Bounds rough_motion(const FilmPlan& plan, const FilmSolvers& solvers, const LoadedFilm& whole) {
  const Zone zone("first pass");
  const ScratchFolder scratch;
  const FilmPlan rough = first_pass(plan, scratch.path);
  LoadedFilm film = load_film(rough, {});
  build_models(rough, film);
  FilmStart start = check_film(rough, film);
  const RunFolder folder = open_folder(start, film);
  (void)make_film(rough, film, start, folder, solvers);  // a pass that fails still gives the frames before its failure
  Bounds box;
  const auto include = [&box](const Positions& points) {
    box.include(bounds_of(points).lower);
    box.include(bounds_of(points).upper);
  };
  for (const Body& body : film.world.bodies()) {
    const Positions& rest = body.description.mesh.rest;
    include(rest);
    PointCacheReader motion(folder.motion(body.def.name));
    for (int frame = 0; frame < motion.frames(); ++frame)
      include(motion.frame(frame).rowwise() + motion_origin(rest).transpose());
  }
  // Coarse bodies may lack the tips of ears and tails, so the box also contains the real bodies at rest.
  for (const Body& body : whole.world.bodies()) include(body.description.mesh.rest);
  for (const DrawnBody& body : whole.drawn) {
    if (body.skin.rest.points.rows() > 0) include(body.skin.rest.points);
  }
  const Vec3 more = Vec3::Constant(air * box.diagonal());
  box.include(box.lower - more);
  box.include(box.upper + more);
  return box;
}

}  // namespace

void find_framing(const FilmPlan& plan, const FilmStart& start, const FilmSolvers& solvers, LoadedFilm& film) {
  const bool asked = film.world.script().scene().camera.frames == Framed::film && plan.pictures != FilmPictures::none;
  if (!asked) return;
  if (start.kept_frames() > 0) film.info.framed = framed_in(read_run(start.place.path).info_json);
  if (!film.info.framed) film.info.framed = rough_motion(plan, solvers, film);
}

}  // namespace supple
