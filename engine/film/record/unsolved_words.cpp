#include "film/record/unsolved_words.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "output/files/json_text.h"
#include "scene/building/warnings.h"

namespace supple {

std::vector<std::string> bodies_meant_unsolved(const SceneDef& scene) {
  std::vector<std::string> meant;
  for (const BodyDef& body : scene.bodies)
    if (is_meant(body, WarningKind::unsolved)) meant.push_back(body.name);
  return meant;
}

UnsolvedWords unsolved_words(const Script& script) {
  const SceneDef& scene = script.scene();
  const auto json = parsed_json<nlohmann::ordered_json>(script.scene_json());
  UnsolvedWords words{bodies_meant_unsolved(scene), {}};
  std::string last;
  int table = -1;
  for (const BodyDef& body : scene.bodies) {
    if (table < 0 || body.table != last) ++table;  // otherwise it is a piece or a copy
    last = body.table;
    const nlohmann::ordered_json::json_pointer own(fmt::format("/body/{}/solver/iterations", table));
    words.options[body.name] = fmt::format("--set {}solver.iterations={}",
                                           json.contains(own) ? fmt::format("body.{}.", body.table) : std::string(),
                                           3 * body.solver.settings.iterations);
  }
  return words;
}

}  // namespace supple
