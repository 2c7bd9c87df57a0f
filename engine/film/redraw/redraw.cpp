#include "film/redraw/redraw.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/hash.h"
#include "base/interrupts.h"
#include "base/text.h"
#include "film/pictures/drawn_film.h"
#include "film/pictures/reference_run.h"
#include "film/plan/film_coding.h"
#include "film/plan/run_plan.h"
#include "film/plan/shipped_files.h"
#include "film/record/film_identity.h"
#include "film/redraw/run_lists.h"
#include "output/files/folder_lock.h"
#include "output/files/json_text.h"
#include "output/files/obj_file.h"
#include "output/files/whole_file.h"
#include "output/run/json_difference.h"
#include "output/run/run_folder.h"
#include "output/run/run_record.h"
#include "render/renderer.h"

namespace supple {
namespace {

using Json = nlohmann::ordered_json;

std::vector<PointCacheReader> motion_of(const RunRecord& run, const LoadedFilm& film) {
  std::vector<PointCacheReader> motion;
  for (const Body& body : film.world.bodies()) {
    motion.emplace_back(run.motion(body.def.name));
    const auto vertices = static_cast<int>(body.description.mesh.rest.rows());
    if (motion.back().points() == vertices) continue;
    throw InputError(run.motion(body.def.name).string(),
                     fmt::format("has {} points, and the body has {} vertices", motion.back().points(), vertices));
  }
  return motion;
}

// Opens what the run kept of the forces of contact, where the field shows them.
std::vector<ForceFileReader> forces_of(const RunRecord& run, const LoadedFilm& film) {
  std::vector<ForceFileReader> forces;
  const SceneDef& scene = film.world.script().scene();
  if (scene.field.quantity != FieldQuantity::force || !scene.may_touch()) return forces;
  for (const Body& body : film.world.bodies()) {
    const std::filesystem::path file = run.forces(body.def.name);
    std::error_code error;
    if (!std::filesystem::exists(file, error))
      throw InputError(file.string(),
                       "is missing, so contact forces cannot be shown: an older program made the run; film it again");
    forces.emplace_back(file);
    const auto vertices = static_cast<int>(body.description.mesh.rest.rows());
    if (forces.back().vertices() != vertices)
      throw InputError(file.string(), fmt::format("has the forces on {} vertices, and the body has {}",
                                                  forces.back().vertices(), vertices));
  }
  return forces;
}

int frames_with_motion(const LoadedDrawing& drawing) {
  int count = drawing.motion.front().frames();
  for (const PointCacheReader& body : drawing.motion) count = std::min(count, body.frames());
  for (const ForceFileReader& body : drawing.forces) count = std::min(count, body.frames());
  return count;
}

std::vector<int> frames_of(const DrawPlan& plan, int count) {
  if (count == 0) throw InputError(plan.run.string(), "has no frame yet");
  const int last = plan.last < 0 ? count - 1 : plan.last;
  if (last >= count)
    throw InputError(fmt::format("--last {}", last), fmt::format("the run's last frame is {}", count - 1));
  if (plan.first > last)
    throw InputError(fmt::format("--first {}", plan.first), fmt::format("lies after the last frame, {}", last));
  std::vector<int> frames;
  for (int frame = plan.first; frame <= last; frame += plan.every) frames.push_back(frame);
  return frames;
}

// Refuses pictures between the frames of the run where they would need another run's motion between its frames.
void check_smooth(const DrawPlan& plan, const SceneDef& scene) {
  if (plan.smooth == 1) return;
  const char* other = !scene.look.ghost.empty()                         ? "look.ghost"
                      : scene.field.quantity == FieldQuantity::distance ? "field distance"
                                                                        : nullptr;
  if (other != nullptr)
    throw InputError(fmt::format("--smooth {}", plan.smooth),
                     fmt::format("draws between the frames of the run, and {} has the other run's frames alone: leave "
                                 "one of the two out",
                                 other));
}

// Returns a rate as a number where it is whole or has few digits, otherwise as text.
Json rate_json(const FrameRate& rate) {
  const std::string text = rate.text();
  return text.find('/') == text.npos ? Json(static_cast<double>(rate)) : Json(text);
}

}  // namespace

LoadedDrawing load_drawing(const DrawPlan& plan) {
  const RunRecord run = read_run(plan.run);
  FilmPlan film = plan_of_run(run, plan.scene, plan.settings);
  film.cache = plan.cache;
  film.quiet = plan.quiet;
  LoadedDrawing drawing{load_film(film, {}), {}, {}, {}, 0, {}, plan.smooth, 30, {}};
  check_same_motion(run, drawing.film);
  check_passes(drawing.film.world.script().scene());
  check_smooth(plan, drawing.film.world.script().scene());
  drawing.film.info.framed = framed_in(run.info_json);
  make_skins(film, drawing.film);
  drawing.motion = motion_of(run, drawing.film);
  drawing.rows = run.rows;
  drawing.forces = forces_of(run, drawing.film);
  drawing.frame_count = frames_with_motion(drawing);
  drawing.frames = frames_of(plan, drawing.frame_count);
  check_references(drawing.film.world.script().scene(), drawing.film.world.bodies(), drawing.frames.front(),
                   drawing.frames.back());
  drawing.rate = plan.rate.value_or(drawing.film.world.script().scene().fps.over(plan.every));
  Json identity = {
      {"program", program_version()},
      {"run", std::filesystem::absolute(plan.run).lexically_normal().string()},
      {"frames", {{"first", drawing.frames.front()}, {"every", plan.every}, {"count", drawing.frames.size()}}},
      {"rate", rate_json(drawing.rate)},
      {"gl", name_of(plan.gl)},
      {"scene", json_if_valid<Json>(drawing.film.info.scene_json)}};
  if (plan.smooth > 1) identity["smooth"] = plan.smooth;
  if (const auto& subtitles = drawing.film.world.script().scene().text.subtitle_file)
    identity["subtitles"] = hash_text_form(subtitles->hash);
  if (!drawing.film.info.replay_json.empty()) identity["replay"] = json_if_valid<Json>(drawing.film.info.replay_json);
  drawing.identity = json_text(identity, 1) + "\n";
  return drawing;
}

int picture_count(const LoadedDrawing& drawing) {
  return (static_cast<int>(drawing.frames.size()) - 1) * drawing.smooth + 1;
}

Moment moment_of(const LoadedDrawing& drawing, int picture) {
  const int every = drawing.frames.size() > 1 ? drawing.frames[1] - drawing.frames[0] : 1;
  const long long parts = static_cast<long long>(picture) * every;
  return {drawing.frames.front() + static_cast<int>(parts / drawing.smooth),
          static_cast<double>(parts % drawing.smooth) / drawing.smooth};
}

Positions saved_positions(LoadedDrawing& drawing, std::size_t body, int frame) {
  const Vec3 origin = motion_origin(drawing.film.world.bodies()[body].description.mesh.rest);
  return drawing.motion[body].frame(frame).rowwise() + origin.transpose();
}

// draw.json is written first, because several processes that draw parts may begin at one time.
void open_drawing(const std::filesystem::path& folder, const LoadedDrawing& drawing, bool keep) {
  std::error_code error;
  const std::filesystem::path record = folder / "draw.json";
  check_left_by(folder, "drawing", "draw.json");
  const bool known = std::filesystem::exists(record, error);
  if (known && keep) {
    std::ifstream file(record);
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    const std::vector<std::string> differences = json_differences(text, drawing.identity, 3);
    if (!differences.empty())
      throw InputError("--out " + folder.string(),
                       "holds another drawing, which differs in " + fmt::format("{}", fmt::join(differences, "; ")));
  }
  const auto make = [&](const std::filesystem::path& made) {
    std::filesystem::create_directories(made, error);
    if (error) throw RunError(fmt::format("{}: cannot be made: {}", made.string(), error.message()));
  };
  make(folder);
  if (!known || !keep) write_whole_file_together(record, drawing.identity);
  make(folder / "frames");
  if (known && !keep) {
    remove_film(folder);
    remove_pictures(folder / "frames", 0);
    remove_passes(folder / "passes", 0);
  }
}

PictureRange part_of(const LoadedDrawing& drawing, int index, int count) {
  const auto pictures = static_cast<long long>(picture_count(drawing));
  return {static_cast<int>(pictures * index / count), static_cast<int>(pictures * (index + 1) / count)};
}

Eigen::Vector2d field_range(LoadedDrawing& drawing) { return RunLists(drawing).drawn().field_range(); }

DrawResult draw_pictures(const DrawPlan& plan, LoadedDrawing& drawing, const std::filesystem::path& folder,
                         PictureRange range, VideoEncoder* video, const std::function<void(int done)>& told) {
  DrawResult result;
  RunLists lists(drawing);
  result.legend = lists.drawn().field_look();
  if (plan.legend_apart && result.legend) lists.drawn().hide_legend();
  const std::vector<PicturePass>& passes = drawing.film.world.script().scene().output.passes;
  Pictures pictures(lists.stage(), plan.gl, shaders_folder(),
                    PictureTargets{folder / "frames", true, video, 0, folder / "passes", passes});
  for (int picture = range.first; picture < range.last; ++picture) {
    if (interrupted()) {
      result.end = FilmEnd::interrupted;
      break;
    }
    if (!pictures.put(picture, lists.list(moment_of(drawing, picture)))) break;
    result.pictures += static_cast<int>(pictures.take_written().size());
    told(result.pictures);
  }
  const bool part = result.end == FilmEnd::done && range.last < picture_count(drawing);
  if (part && pictures.want_next()) pictures.put_next(range.last, lists.list(moment_of(drawing, range.last)));
  pictures.finish();
  result.pictures += static_cast<int>(pictures.take_written().size());
  told(result.pictures);
  result.message = pictures.error();
  if (!result.message.empty()) result.end = FilmEnd::failed;
  return result;
}

Image draw_still(const DrawPlan& plan, LoadedDrawing& drawing, int frame) {
  RunLists lists(drawing);
  return Renderer(lists.stage(), plan.gl, shaders_folder()).draw(lists.list({frame, 0}));
}

std::vector<int> missing_pictures(const LoadedDrawing& drawing, const std::filesystem::path& folder) {
  std::vector<int> missing;
  std::error_code error;
  for (int picture = 0; picture < picture_count(drawing); ++picture) {
    if (!std::filesystem::exists(picture_file(folder / "frames", picture), error)) missing.push_back(picture);
  }
  return missing;
}

}  // namespace supple
