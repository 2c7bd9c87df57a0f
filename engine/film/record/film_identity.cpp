#include "film/record/film_identity.h"

#include <fmt/core.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/hash.h"
#include "output/files/json_text.h"

namespace supple {
namespace {

// Lists the files that were read in addition to the scene and the replay, including those of shapes that colliders take
// on later, even if only in a longer film. Files are listed by their names without folders, so that a film can be
// resumed after it was moved.
nlohmann::ordered_json files_of(const Script& script, const std::vector<Body>& bodies) {
  std::vector<SourceFile> files;
  const auto add = [&files](const std::vector<SourceFile>& more) {
    files.insert(files.end(), more.begin(), more.end());
  };
  const auto add_colliders = [&add](const SceneDef& scene) {
    for (const ColliderDef& collider : scene.colliders) add(collider.shape.files);
  };
  for (const Body& body : bodies) add(body.files);
  add_colliders(script.scene());
  if (const auto& subtitles = script.scene().text.subtitle_file) files.push_back(*subtitles);
  for (const TimedChange& change : script.changes()) {
    if (!change.cost.surface || change.over > 0) continue;  // a ramp cannot change a file's name
    try {
      add_colliders(script.scene_at(static_cast<int>(std::min(change.at, 1e6) * script.scene().fps + 1e-6)));
    } catch (const InputError&) {  // only after the end of the film, where changes may be wrong
    }
  }
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const SourceFile& file : files) {
    const nlohmann::ordered_json entry = {{"name", file.path.filename().string()},
                                          {"xxh64", hash_text_form(file.hash)}};
    if (std::find(list.begin(), list.end(), entry) == list.end()) list.push_back(entry);
  }
  return list;
}

// Describes the pictures that a film leaves as files; there are none when it leaves only the video.
nlohmann::ordered_json images_of(const FilmPlan& plan) {
  if (plan.film_only) return "film only";
  return plan.pictures != FilmPictures::none;
}

}  // namespace

std::string identity_of(const RunInfo& info, const Script& script, const std::vector<Body>& bodies,
                        const FilmPlan& plan) {
  nlohmann::ordered_json scene = parsed_json<nlohmann::ordered_json>(info.scene_json);
  scene.erase("frames");
  nlohmann::ordered_json meshes;
  for (const RunInfo::Mesh& mesh : info.meshes) meshes[mesh.body] = mesh.hash;
  nlohmann::ordered_json identity = {
      {"program", fmt::format("{} {}", program_version(), hash_text_form(program_identity()))},
      {"kernels", info.kernel_variant},
      {"cpu", cpu_name()},
      {"images", images_of(plan)},
      {"gl", name_of(plan.gl)},
      {"vtu", plan.fields_every},
      {"meshes", meshes},
      {"files", files_of(script, bodies)},
      {"scene", scene}};
  if (!info.replay_json.empty()) identity["replay"] = parsed_json<nlohmann::ordered_json>(info.replay_json);
  return json_text(identity);
}

RecordHead record_head(const RunInfo& info, const std::vector<Body>& bodies) {
  nlohmann::ordered_json film = {{"scene", parsed_json<nlohmann::ordered_json>(info.scene_json)}};
  film["scene"].erase("frames");
  if (!info.replay_json.empty()) film["replay"] = parsed_json<nlohmann::ordered_json>(info.replay_json);
  RecordHead head{hash_text_form(program_identity()), info.kernel_variant, json_text(film), {}};
  for (const Body& body : bodies) head.bodies.push_back({body.def.name, int(body.description.mesh.rest.rows())});
  return head;
}

}  // namespace supple
