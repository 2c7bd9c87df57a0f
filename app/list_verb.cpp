#include <fmt/format.h>

#include <algorithm>

#include "app/verbs.h"
#include "base/console.h"
#include "scene/scene_reader.h"

namespace supple {
namespace {

int list_scenes() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(assets_folder() / "scenes")) {
    if (entry.path().extension() == ".toml") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  for (const std::filesystem::path& file : files) {
    const SceneDef scene = load_scene(file, assets_folder(), {});
    say(stdout, fmt::format("{:<22}{}\n", scene.name, scene.title));
  }
  return 0;
}

}  // namespace

void add_list(CLI::App& app, Action& action) {
  CLI::App* verb = app.add_subcommand("list", "The scenes that ship, a line each.");
  verb->callback([&action] { action = list_scenes; });
}

}  // namespace supple
