// Writes a script with all its edits as a replay.
#include <fmt/format.h>

#include <cmath>

#include "base/error.h"
#include "scene/reading/replay_start.h"
#include "scene/replay/script_parts.h"

namespace supple {
namespace {

ConfigValue value_of_text(const std::string& text, const std::string& source = "") {
  return ConfigValue::parse(text, source).value();
}

// Returns the name by which a replay that lies in `folder` names the scene of a file.
std::string scene_name(const std::filesystem::path& file, const std::filesystem::path& folder,
                       const std::filesystem::path& assets) {
  std::error_code error;
  const std::filesystem::path scene = std::filesystem::weakly_canonical(std::filesystem::absolute(file), error);
  if (std::filesystem::equivalent(scene, assets / "scenes" / (scene.stem().string() + ".toml"), error))
    return scene.stem().string();
  if (folder == folder.root_path()) return scene.string();  // nothing is near to the root
  const std::filesystem::path near =
      scene.lexically_relative(std::filesystem::weakly_canonical(std::filesystem::absolute(folder), error));
  return near.empty() || near.native().starts_with("..") ? scene.string() : near.string();
}

// Returns a change as [[change]] has it.
ConfigValue table_of_change(const TimedChange& change, const FrameRate& fps) {
  Config table = Config::parse("", "", "");
  const auto put = [&table](const char* key, const ConfigValue& value) { table.put(key, value, {}, {}); };
  put("frame", value_of_text(fmt::format("{}", std::lround(change.at * fps))));
  put("path", value_of_text(toml_text(change.path)));
  if (change.over > 0) {
    put("over", value_of_text(fmt::format("{}", change.over)));
    put("ease", value_of_text(toml_text(name_of(change.ease))));
    put("by", value_of_text(toml_text(name_of(change.by))));
    put("from", change.from.value());
  }
  put("value", change.to);
  return table.root().all_but("");
}

}  // namespace

Config document_of(const LiveGrab& grab) {
  const std::string source = fmt::format("grab of body '{}'", grab.body);
  Config table = Config::parse("", source, "");
  const auto put = [&](const char* key, const std::string& text) {
    table.put(key, value_of_text(text, source), {source}, {});
  };
  put("body", toml_text(grab.body));
  put("name", toml_text(grab.name));
  put("select", fmt::format("{{ vertices = [{}] }}", fmt::join(grab.vertices, ", ")));
  put("stiffness", fmt::format("{}", grab.stiffness));
  put("ease", toml_text(name_of(Ease::linear)));
  put("from", fmt::format("{}", grab.from));
  if (std::isfinite(grab.until)) put("until", fmt::format("{}", grab.until));
  return table;
}

namespace {

// Returns a document without the parts that a replay sets by itself, for comparisons.
std::string comparable(const Config& document) {
  Config copy = document.copy();
  copy.make_files_absolute();
  for (const char* key : {"frames", "title"}) copy.remove(key);
  return copy.as_json();
}

}  // namespace

std::optional<std::string> Script::with_the_scene_named(Config replay, const std::string& scene,
                                                        const std::filesystem::path& file) const {
  const Parts& parts = *parts_;
  replay.put("scene", value_of_text(toml_text(scene)), {}, {});
  for (const std::string& setting : parts.settings) {
    const std::size_t equals = setting.find('=');
    const auto value = ConfigValue::parse(setting.substr(equals + 1));
    replay.put_key("set", setting.substr(0, equals),
                   value ? *value : value_of_text(toml_text(setting.substr(equals + 1))));
  }
  for (const LiveGrab& grab : parts.edits.grabs) replay.append("grab", document_of(grab).root().all_but(""), {});
  replay.make_files_absolute();
  std::string text = replay.as_toml() + "\n";
  // Changes were checked when they were made, take long to be checked, and are no part of the scene at the start.
  for (const char* key : {"change", "session"}) replay.remove(key);
  try {
    const Script read = load(SceneSource(file, replay.as_toml()), parts.scene_file.assets(), {});
    if (comparable(read.parts_->scene_file) == comparable(parts.scene_file)) return text;
  } catch (const InputError&) {  // load() throws where a setting reaches a grab
  }
  return std::nullopt;
}

// The replay names the scene's file and has the settings in [set]. Settings may reach a grab, or depend on their order,
// so this does not always give the same scene; where it does not, the scene is written anew.
ReplayFiles Script::replay_files(const std::filesystem::path& file, int frames, const PlayedSession& session) const {
  Parts& parts = *parts_;
  const std::filesystem::path& assets = parts.scene_file.assets();
  const std::filesystem::path scene = parts.replay ? replayed_scene(*parts.replay, assets) : parts.source.path;
  std::error_code error;
  if (!parts.source.text && std::filesystem::equivalent(scene, file, error))
    throw InputError(file.string(), "is the scene itself, which the replay would write over");
  Config replay = parts.replay ? parts.replay->copy() : Config::parse("", file.string(), assets);
  replay.make_files_absolute();
  replay.put("frames", value_of_text(fmt::format("{}", frames)), {}, {});
  put_session(replay, session);
  for (const TimedChange& change : parts.edits.changes)
    replay.append("change", table_of_change(change, parts.start.fps), {});
  if (!parts.source.text) {
    if (const auto text = with_the_scene_named(replay.copy(), scene_name(scene, file.parent_path(), assets), file))
      return {*text, {}, {}};
  }
  ReplayFiles files;
  files.scene = file.parent_path() / (file.stem().string() + "-scene.toml");
  if (std::filesystem::equivalent(scene, files.scene, error))
    throw InputError(files.scene.string(), "is the scene itself, which the replay would write over");
  Config whole = parts.scene_file.copy();
  whole.make_files_absolute();
  files.scene_text = whole.as_toml() + "\n";
  for (const char* key : {"set", "grab"}) replay.remove(key);
  replay.put("scene", value_of_text(toml_text(files.scene.filename().string())), {}, {});
  replay.make_files_absolute();
  files.replay_text = replay.as_toml() + "\n";
  return files;
}

}  // namespace supple
