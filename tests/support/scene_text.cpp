#include "support/scene_text.h"

#include "scene/reading/scene_reader.h"
#include "support/bodies.h"

namespace supple::test {

std::vector<std::string> problems_of(const std::string& text) {
  Config config = Config::parse(text, "scene.toml", assets);
  (void)read_scene(config);
  std::vector<std::string> list;
  for (const Problem& problem : config.take_problems()) list.push_back(problem.text());
  return list;
}

SceneDef scene_of(const std::string& text) {
  Config config = Config::parse(text, "scene.toml", assets);
  SceneDef scene = read_scene(config);
  config.finish();
  return scene;
}

}  // namespace supple::test
