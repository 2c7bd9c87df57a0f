#include "scene/reading/replay_start.h"

#include "scene/reading/model_scene.h"
#include "scene/reading/scene_reader.h"

namespace supple {
std::filesystem::path replayed_scene(Config& replay, const std::filesystem::path& assets) {
  const ConfigTable root = replay.root();
  const Key key = {"scene", "", "a scene file, or the name of one that ships"};
  const std::string name = root.text(key, std::nullopt);
  std::filesystem::path shipped = assets / "scenes" / (name + ".toml");
  std::error_code error;
  return !name.empty() && std::filesystem::is_regular_file(shipped, error) ? shipped : root.file(key);
}

bool is_replay(Config& document) {
  const ConfigTable root = document.root();
  return root.has("scene") || root.has("change") || root.has("grab");
}

Config start_of_replay(Config& replay, const std::filesystem::path& assets, std::vector<Problem>& problems,
                       const PutsValue& put) {
  const std::filesystem::path file = replayed_scene(replay, assets);
  if (file.empty()) throw InputError(replay.complaints());
  Config scene_file = load_document(file, assets);
  const ConfigTable root = replay.root();
  if (const auto title = root.value({"title", "", "for people"}, "the scene's"))
    scene_file.put("title", *title, root.place("title"), {});
  if (const auto frames = root.value({"frames", "", "length of the film"}, "the scene's"))
    scene_file.put("frames", *frames, root.place("frames"), {});
  if (const auto set = root.table({"set", "", "values of the scene, by their paths in quotes, from the start on"})) {
    for (const std::string& path : set->keys())
      put(scene_file, path, *set->value({path.c_str(), "", ""}), set->place(path.c_str()));
  }
  for (const ConfigTable& table : root.tables({"grab", "", "a handle for a body, with the keys of [[body.handles]]"})) {
    const std::string body = table.text({"body", "", "whose vertices are grabbed"}, std::nullopt);
    if (body.empty()) continue;
    try {
      scene_file.append("body." + body + ".handles", table.all_but("body"), table.place("body"));
    } catch (const InputError& error) {
      problems.insert(problems.end(), error.problems().begin(), error.problems().end());
    }
  }
  return scene_file;
}

}  // namespace supple
