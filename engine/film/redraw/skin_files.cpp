#include "film/redraw/skin_files.h"

#include <fmt/core.h>

#include <system_error>

#include "base/error.h"
#include "base/interrupts.h"
#include "film/pictures/film_stage.h"
#include "output/files/colored_obj.h"
#include "output/files/folder_lock.h"
#include "output/files/obj_file.h"
#include "output/files/whole_file.h"

namespace supple {
namespace {

// Writes one body's skin at rest. Returns the place that its files are relative to [m].
Vec3 write_rest(const std::filesystem::path& file, const DrawnBody& drawn) {
  const Skin& skin = drawn.skin;
  const Vec3 origin = motion_origin(skin.rest.points);
  if (skin.color.empty())
    write_obj(file, skin.rest.points, skin.rest.triangles, origin);
  else
    write_colored_obj(file, {skin.rest.points, skin.rest.triangles, skin.color, drawn.textures.get(), origin});
  return origin;
}

}  // namespace

void open_skins(const std::filesystem::path& folder, const LoadedDrawing& drawing) {
  std::error_code error;
  check_left_by(folder, "skins", "skins.json");
  std::filesystem::remove_all(folder / "motion", error);
  std::filesystem::create_directories(folder / "motion", error);
  if (error) throw RunError(fmt::format("{}: cannot be made: {}", folder.string(), error.message()));
  write_whole_file(folder / "skins.json", drawing.identity);
}

int write_skins(LoadedDrawing& drawing, const std::filesystem::path& folder, const std::function<void(int)>& told) {
  const std::vector<Body>& bodies = drawing.film.world.bodies();
  limit_stretch(drawing.film.drawn);
  std::vector<PointCacheWriter> caches;
  std::vector<Vec3> origins;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const std::filesystem::path file = folder / "motion" / bodies[b].def.name;
    const DrawnBody& drawn = drawing.film.drawn[b];
    origins.push_back(write_rest(file.string() + ".obj", drawn));
    caches.emplace_back(file.string() + ".pc2", static_cast<int>(drawn.skin.rest.points.rows()));
  }
  int done = 0;
  for (const int frame : drawing.frames) {
    if (interrupted()) break;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      const Positions now = saved_positions(drawing, b, frame);
      const Positions skin = skin_places(drawing.film.drawn[b], bodies[b].description.mesh, now);
      caches[b].add(skin.rowwise() - origins[b].transpose());
    }
    told(++done);
  }
  return done;
}

}  // namespace supple
