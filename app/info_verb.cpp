#include <fmt/core.h>

#include <algorithm>
#include <memory>
#include <thread>

#include "app/summary.h"
#include "app/verbs.h"
#include "base/console.h"
#include "base/error.h"
#include "base/near_files.h"
#include "film/plan/shipped_files.h"
#include "geometry/files/mesh_file.h"
#include "scene/reading/model_scene.h"

namespace supple {
namespace {

// Refuses a name that leads nowhere, where something with a name like it can be looked at: a run, a model or a scene. A
// name without a folder may also mean a scene that ships.
void refuse_mistyped(const std::string& input) {
  std::vector<std::string> shipped;
  for (const char* kind : {"scenes", "replays"})
    for (std::string& name : shipped_names(kind)) shipped.push_back(std::move(name));
  std::error_code error;
  const bool known = input == "-" || std::filesystem::exists(input, error) || std::ranges::count(shipped, input) > 0;
  if (known) return;
  const auto shows = [](const std::filesystem::path& entry) {
    return is_run(entry) || entry.extension() == ".toml" || is_model(entry) || is_mesh_file(entry);
  };
  if (std::filesystem::path(input).has_parent_path()) shipped.clear();
  const std::filesystem::path near = near_file(input, shows, shipped);
  if (!near.empty()) throw InputError(input, (is_run(near) ? "no such folder" : "no such file") + meant_file(near));
}

// Prints what is in an input. Its kind follows from what is on the disk: a folder is a run, files with the endings of
// meshes and surfaces are models, and all else is a scene.
int inform(const std::string& input, bool live) {
  std::error_code error;
  const std::filesystem::path path = input;
  const bool scene_wanted = live && (std::filesystem::is_directory(path, error) || is_model(path));
  if (scene_wanted) throw InputError(input, "is no scene: --live lists what of a scene can change");
  if (std::filesystem::is_directory(path, error)) {
    say(stdout, run_summary(read_run(path)));
    return 0;
  }
  if (is_mesh_file(path)) {
    const MeshFile file = read_mesh(path);
    for (const std::string& note : file.notes) say(stdout, fmt::format("note: {}\n", note));
    say(stdout, mesh_summary(file.mesh));
    return 0;
  }
  refuse_mistyped(input);
  const SceneSource scene = scene_source(input);
  if (is_model(scene.path)) {
    say(stdout, surface_summary(scene.path));
  } else if (!scene.text && scene.path.extension() != ".toml") {
    throw InputError(input, "neither a mesh, a surface, a scene (.toml, or a name of supple list) nor a run's folder");
  }
  if (live) {
    say(stdout, live_summary(scene));
    return 0;
  }
  say(stdout, scene_summary(scene, static_cast<int>(std::max(1u, std::thread::hardware_concurrency()))));
  return 0;
}

}  // namespace

void add_info(CommandLine& line) {
  auto input = std::make_shared<std::string>();
  auto live = std::make_shared<bool>(false);
  Verb verb = line.verb("info", "What is in a mesh, a surface, a scene, a replay or the folder of a run.");
  verb.footer(
      "Examples: supple info model.obj, supple info squirrel.mesh, supple info squirrel, supple info --live squirrel, "
      "supple info "
      "out/squirrel\n"
      "Of a scene the first frames are simulated, to tell what one costs here; nothing is written.");
  verb.option("SCENE|REPLAY|MODEL|RUN", *input,
              "mesh, surface, scene or replay file or the name of one that ships, - for a scene on standard input, or "
              "a folder "
              "that supple render left")
      .required();
  verb.flag("--live", *live, "list what of a scene can change while it runs, and what that costs");
  verb.runs([input, live] { return inform(*input, *live); });
}

}  // namespace supple
