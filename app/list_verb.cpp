#include <fmt/core.h>

#include "app/verbs.h"
#include "base/console.h"
#include "base/text.h"
#include "film/plan/shipped_files.h"
#include "scene/reading/scene_reader.h"
#include "scene/replay/script.h"

namespace supple {
namespace {

int list_scenes() {
  for (const std::string& name : shipped_names("scenes")) {
    const SceneDef scene = load_scene(assets_folder() / "scenes" / (name + ".toml"), assets_folder(), {});
    say(stdout, fmt::format("{:<22}{}\n", scene.name, printable(scene.title)));
  }
  say(stdout, "\nReplays, for supple replay:\n");
  for (const std::string& name : shipped_names("replays")) {
    const Script script = Script::load(assets_folder() / "replays" / (name + ".toml"), assets_folder(), {});
    say(stdout, fmt::format("{:<22}{}\n", name, printable(script.scene().title)));
  }
  return 0;
}

}  // namespace

void add_list(CommandLine& line) {
  Verb verb = line.verb("list", "The scenes and replays that ship, a line each.");
  verb.footer("Example: supple list");
  verb.runs(list_scenes);
}

}  // namespace supple
