#include <fmt/core.h>

#include <algorithm>
#include <memory>
#include <thread>

#include "app/summary.h"
#include "app/verbs.h"
#include "base/console.h"
#include "base/error.h"
#include "film/places.h"
#include "geometry/mesh_file.h"

namespace supple {
namespace {

// The kind of an input follows from what is on the disk: a folder is a run, a .mesh file is a mesh, and all else is a
// scene.
int inform(const std::string& input, bool live) {
  std::error_code error;
  const std::filesystem::path path = input;
  const bool scene_wanted = live && (std::filesystem::is_directory(path, error) || path.extension() == ".mesh");
  if (scene_wanted) throw InputError(input, "is no scene: --live lists what of a scene can change");
  if (std::filesystem::is_directory(path, error)) {
    say(stdout, run_summary(read_run(path)));
    return 0;
  }
  if (path.extension() == ".mesh") {
    const MeshFile file = read_mesh(path);
    for (const std::string& note : file.notes) say(stdout, fmt::format("note: {}\n", note));
    say(stdout, mesh_summary(file.mesh));
    return 0;
  }
  const std::filesystem::path scene = scene_file(input);
  if (scene.extension() != ".toml")
    throw InputError(input, "neither a MEDIT .mesh file, a scene (.toml, or a name of supple list) nor a run's folder");
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
  Verb verb = line.verb("info", "What is in a mesh, a scene, a replay or the folder of a run.");
  verb.footer(
      "Examples: supple info squirrel.mesh, supple info squirrel, supple info --live squirrel, supple info "
      "out/squirrel\n"
      "Of a scene the first frames are simulated, to tell what one costs here; nothing is written.");
  verb.option(
          "SCENE|REPLAY|MESH|RUN", *input,
          "MEDIT .mesh file, scene or replay file or the name of one that ships, or a folder that supple render left")
      .required();
  verb.flag("--live", *live, "list what of a scene can change while it runs, and what that costs");
  verb.runs([input, live] { return inform(*input, *live); });
}

}  // namespace supple
