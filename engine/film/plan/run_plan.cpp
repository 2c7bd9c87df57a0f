#include "film/plan/run_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "output/files/json_text.h"
#include "output/run/json_difference.h"

namespace supple {
namespace {

using Json = nlohmann::ordered_json;

// Lists the values of a scene that change what is seen and nothing else, by the names that generic_path() gives them. A
// name also covers all values below it.
constexpr std::array seen = {"title",
                             "camera",
                             "look",
                             "field",
                             "text",
                             "output.size",
                             "output.width",
                             "output.height",
                             "output.samples",
                             "output.blur_samples",
                             "output.passes",
                             "body[].color",
                             "body[].back_color",
                             "body[].yarn",
                             "body[].gloss",
                             "body[].roughness",
                             "body[].translucent",
                             "body[].label",
                             "body[].meant",
                             "body[].pattern",
                             "body[].pattern_size",
                             "body[].skin_cells",
                             "collider[].color",
                             "collider[].roughness",
                             "collider[].translucent",
                             "collider[].visible"};

bool is_seen(const std::string& path) {
  const std::string generic = generic_path(path);
  return std::ranges::any_of(seen, [&generic](const std::string& one) {
    return generic == one || (generic.starts_with(one) && generic[one.size()] == '.');
  });
}

std::string member_text(const Json& object, const char* key) {
  return object.contains(key) ? json_text(object[key]) : std::string();
}

}  // namespace

FilmPlan plan_of_run(const RunRecord& run, const std::filesystem::path& scene,
                     const std::vector<std::string>& settings) {
  const Json info = parsed_json<Json>(run.info_json);
  const std::string source = (run.folder / "run.json").string();
  const bool whole = info.contains("scene_file") && info["scene_file"].is_string() && info.contains("settings") &&
                     info["settings"].is_array() && info.contains("scene");
  if (!whole) throw InputError(source, "does not tell the run's scene and settings: an older program made the run");
  FilmPlan film;
  film.scene = scene.empty() ? info["scene_file"].get<std::string>() : scene.string();
  std::error_code error;
  if (scene.empty() && info.contains("scene_text") && info["scene_text"].is_string()) {
    film.scene_text = info["scene_text"].get<std::string>();
  } else if (!std::filesystem::is_regular_file(film.scene, error)) {
    throw InputError(film.scene,
                     "the run's scene is no longer there; supple draw takes it from elsewhere, with --scene FILE");
  }
  for (const Json& setting : info["settings"]) film.settings.push_back(setting.get<std::string>());
  // A width or height in `settings` takes the place of the size by name that the run was given.
  const bool sized = std::ranges::any_of(settings, [](const std::string& setting) {
    return setting.starts_with("output.width=") || setting.starts_with("output.height=");
  });
  if (sized) std::erase_if(film.settings, [](const std::string& one) { return one.starts_with("output.size="); });
  film.settings.insert(film.settings.end(), settings.begin(), settings.end());
  if (info.contains("sweep_point")) film.sweep_point = info["sweep_point"].get<std::size_t>();
  return film;
}

double time_in_run(const RunRecord& run, int frame) {
  try {
    const Json scene = parsed_json<Json>(run.info_json).at("scene");
    SceneDef clock;
    if (const auto rate = scene.find("fps"); rate != scene.end())
      clock.fps = rate->is_string() ? FrameRate::parse(rate->get<std::string>()).value_or(clock.fps)
                                    : FrameRate(rate->get<double>());
    if (const auto from = scene.find("from"); from != scene.end()) {
      clock.from.emplace().frame = from->at("frame").get<int>();
      if (from->contains("clock")) clock.from->clock = from->at("clock").get<double>();
    }
    return clock.time_after(frame);
  } catch (const Json::exception&) {
    throw InputError((run.folder / "run.json").string(), "is damaged: it does not tell the rate of the run's frames");
  }
}

namespace {

// Keeps only those changes of a replay that change what is simulated.
std::string simulated_part(const std::string& replay) {
  Json json = json_if_valid<Json>(replay);
  if (!json.is_object()) return replay;
  json.erase("title");
  if (!json.contains("change") || !json["change"].is_array()) return json_text(json);
  Json kept = Json::array();
  for (const Json& change : json["change"]) {
    const bool drawn = change.is_object() && change.contains("path") && change["path"].is_string() &&
                       is_seen(change["path"].get<std::string>());
    if (!drawn) kept.push_back(change);
  }
  json["change"] = kept;
  return json_text(json);
}

}  // namespace

void check_same_motion(const RunRecord& run, const LoadedFilm& film) {
  const Json info = parsed_json<Json>(run.info_json);
  std::vector<Problem> problems;
  for (const JsonDifference& difference : differing_values(json_text(info["scene"]), film.info.scene_json)) {
    if (is_seen(difference.path)) continue;
    // One of the two may have no table [output]; of its keys, only `energy` does not concern what is seen.
    const bool seen_output =
        difference.path == "output" && (difference.a + difference.b).find("energy") == std::string::npos;
    if (seen_output) continue;
    problems.push_back({film.info.scene_file, 0, 0,
                        fmt::format("{} is {} here and was {} in the run: only what is seen may differ (title, "
                                    "camera, look, field, text, output's size, width, height, samples, blur_samples "
                                    "and passes, colours, labels, patterns, colliders being visible)",
                                    difference.path, difference.b, difference.a)});
  }
  if (simulated_part(member_text(info, "replay")) != simulated_part(film.info.replay_json))
    problems.push_back({film.info.scene_file, 0, 0, "the replay changes other values than it did in the run"});
  Json meshes = Json::array();
  for (const RunInfo::Mesh& mesh : film.info.meshes) meshes.push_back({mesh.body, mesh.hash});
  Json then = Json::array();
  for (const Json& mesh : info.value("meshes", Json::array())) then.push_back({mesh["body"], mesh["xxh64"]});
  if (problems.empty() && meshes != then)
    problems.push_back(
        {run.folder.string(), 0, 0, "the run had other meshes: their files, or the program, have changed"});
  if (!problems.empty()) throw InputError(std::move(problems));
}

}  // namespace supple
