#include "film/plan/loaded_film.h"

#include <fmt/core.h>

#include <algorithm>
#include <future>
#include <nlohmann/json.hpp>
#include <thread>

#include "base/error.h"
#include "base/hash.h"
#include "base/trace.h"
#include "base/variants.h"
#include "film/plan/preview.h"
#include "film/plan/run_plan.h"
#include "film/plan/shipped_files.h"
#include "film/plan/slow_work_line.h"
#include "output/files/json_text.h"
#include "output/run/run_record.h"
#include "scene/config/config.h"
#include "scene/reading/picture_size.h"
#include "scene/replay/script_trial.h"

namespace supple {

const char* text_of(FilmEnd end) {
  switch (end) {
    case FilmEnd::done: return "done";
    case FilmEnd::interrupted: return "interrupted";
    case FilmEnd::failed: break;
  }
  return "failed";
}

void check_save_states(const std::vector<int>& frames, const SceneDef& scene, const std::filesystem::path& run,
                       int start) {
  const auto is_there = [&](int frame) {
    return std::all_of(scene.bodies.begin(), scene.bodies.end(), [&](const BodyDef& body) {
      return std::filesystem::exists(run / "states" / fmt::format("{}-{:06}", body.name, frame) / "state.json");
    });
  };
  const auto flowing = std::ranges::find_if(scene.bodies, [](const BodyDef& body) { return body.flows(); });
  if (!frames.empty() && flowing != scene.bodies.end())
    throw InputError(
        fmt::format("--save-state {}", frames.front()),
        fmt::format("body '{}' keeps dents or creeps, and files of states have no room for what has flowed",
                    flowing->name));
  for (const int frame : frames) {
    if (frame < start && !is_there(frame))
      throw InputError(fmt::format("--save-state {}", frame),
                       fmt::format("the film goes on with frame {}; earlier states are gone, and only without --resume "
                                   "they come again",
                                   start));
    if (frame < scene.frames) continue;
    throw InputError(fmt::format("--save-state {}", frame),
                     scene.frames == 1
                         ? std::string("the film has one frame, 0")
                         : fmt::format("the film has {} frames, 0 to {}", scene.frames, scene.frames - 1));
  }
}

SceneSource source_of(const FilmPlan& plan) {
  return plan.scene_text ? SceneSource(plan.scene, *plan.scene_text) : SceneSource(scene_file(plan.scene));
}

namespace {

// Returns the setting for the clock of a film that goes on from a run; empty where the frame's number tells it. A run
// that is gone is refused by those who need more of it.
std::string clock_setting(const SceneDef& scene) {
  if (!scene.from || scene.from->clock || !is_run(scene.from->run)) return "";
  const double time = time_in_run(read_run(scene.from->run), scene.from->frame);
  return time == scene.time_at_start() ? "" : fmt::format("from.clock={}", time);
}

}  // namespace

Script load_script(const SceneSource& source, std::vector<std::string>& settings,
                   std::optional<std::size_t> sweep_point) {
  Script script = Script::load(source, assets_folder(), settings, sweep_point);
  const std::string clock = clock_setting(script.scene());
  if (clock.empty()) return script;
  settings.push_back(clock);
  return Script::load(source, assets_folder(), settings, sweep_point);
}

namespace {

// Returns the XXH64 of the points and elements of a body.
std::string mesh_hash(const Body& body) {
  const TetMesh& mesh = body.description.mesh;
  std::uint64_t hash = hash_bytes(mesh.rest.data(), sizeof(double) * mesh.rest.size());
  hash = hash_bytes(mesh.tets.data(), sizeof(std::int32_t) * mesh.tets.size(), hash);
  for (const Spring& spring : body.description.springs) {
    const std::int32_t ends[] = {spring.from, spring.to};
    hash = hash_bytes(ends, sizeof ends, hash);
  }
  for (const FlatTriangle& triangle : body.description.cloth) {
    hash = hash_bytes(triangle.corner.data(), sizeof triangle.corner, hash);
    hash = hash_bytes(triangle.edges, sizeof triangle.edges, hash);
  }
  return hash_text_form(hash);
}

RunInfo run_info(const FilmPlan& plan, const SceneSource& source, const World& world) {
  RunInfo info;
  info.scene_file = std::filesystem::absolute(source.path).lexically_normal().string();
  info.scene_text = source.text;
  info.preview = plan.preview;
  info.sweep_point = plan.sweep_point;
  info.scene_json = world.script().scene_json();
  info.replay_json = world.script().replay_json();
  info.kernel_variant = variant_name(best_variant());
  info.threads = plan.threads > 0 ? plan.threads : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  for (const Body& body : world.bodies()) {
    const TetMesh& mesh = body.description.mesh;
    const auto elements = static_cast<int>(elements_of(body.description));
    info.meshes.push_back({body.def.name, body.source, mesh_hash(body), int(mesh.rest.rows()), elements});
  }
  return info;
}

LoadedFilm film_with(const FilmPlan& plan, std::vector<std::string> settings, const std::vector<std::string>& command) {
  Zone zone("read scene");
  const SceneSource source = source_of(plan);
  Script script = load_script(source, settings, plan.sweep_point);
  check_save_states(plan.save_states, script.scene(), {}, 0);
  zone.next("assemble meshes");
  SlowWorkLine tells(plan.quiet);
  std::vector<Body> bodies = assemble(script.scene(), slow_work_with(plan.cache, tells));
  World world(std::move(script), std::move(bodies));
  RunInfo info = run_info(plan, source, world);
  info.command = command;
  info.settings = std::move(settings);
  return {std::move(world), {}, std::move(info)};
}

// Loads the coarsest form of the scene that can be meshed: thin parts may want finer elements.
LoadedFilm load_coarse(const FilmPlan& plan, const std::vector<std::string>& settings,
                       const std::vector<std::string>& command) {
  const SceneDef scene = Script::load(source_of(plan), assets_folder(), settings, plan.sweep_point).scene();
  const auto with = [&](double share) {
    std::vector<std::string> all = settings;
    for (std::string& setting : preview_settings(scene, share)) all.push_back(std::move(setting));
    return all;
  };
  for (const double share : {plan.rough, 0.25, 0.5}) {
    if (share < plan.rough || share <= 0) continue;
    try {
      return film_with(plan, with(share), command);
    } catch (const InputError&) {  // the last attempt says what is wrong
    }
  }
  return film_with(plan, with(1), command);
}

}  // namespace

std::string size_setting(const std::string& size, const std::vector<std::string>& settings) {
  if (!picture_size(size)) throw InputError("--size " + size, "is none of " + picture_size_words());
  for (const std::string& setting : settings) {
    if (setting.starts_with("output.width=") || setting.starts_with("output.height=") ||
        setting.starts_with("output.size="))
      throw InputError("--set " + setting, "and --size " + size + " both say how large the pictures are");
  }
  return "output.size=" + size;
}

namespace {

// Returns the setting for --from.
std::string from_setting(const FilmPlan& plan) {
  const RunRecord run = read_run(plan.from);
  int frame = plan.from_frame;
  if (frame < 0) {
    frame = parsed_json<nlohmann::json>(run.info_json).value("frames", 0) - 1;
    if (frame < 0)
      throw InputError("--from " + plan.from, "the run has not ended, so that --frame has to say from which frame");
  }
  const std::string folder = std::filesystem::absolute(plan.from).lexically_normal().string();
  return fmt::format("from={{run = {}, frame = {}}}", toml_text(folder), frame);
}

}  // namespace

LoadedFilm load_film(const FilmPlan& plan, const std::vector<std::string>& command) {
  std::vector<std::string> settings = plan.settings;
  if (!plan.from.empty()) settings.push_back(from_setting(plan));
  if (!plan.size.empty()) settings.push_back(size_setting(plan.size, plan.settings));
  if (plan.frames > 0) settings.push_back(fmt::format("frames={}", plan.frames));
  if (plan.seed >= 0) settings.push_back(fmt::format("seed={}", plan.seed));
  return plan.preview || plan.rough > 0 ? load_coarse(plan, settings, command) : film_with(plan, settings, command);
}

void build_models(const FilmPlan& plan, LoadedFilm& film) {
  const Zone zone("build models");
  try_changes(film.world.script(), film.world.bodies());
  std::future<void> skins;
  if (plan.pictures != FilmPictures::none) {
    skins = std::async(std::launch::async, [&plan, &film] {
      name_thread("skins");
      make_skins(plan, film);
    });
  }
  film.world.build_models();
  if (skins.valid()) skins.get();
}

void make_skins(const FilmPlan& plan, LoadedFilm& film) {
  const Zone zone("make skins");
  SlowWorkLine tells(plan.quiet);
  const bool as_elements = film.world.script().scene().look.wireframe;
  film.drawn = drawn_bodies(film.world.bodies(), slow_work_with(plan.cache, tells),
                            as_elements ? DrawnAs::elements : DrawnAs::skin);
}

}  // namespace supple
