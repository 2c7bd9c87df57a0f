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
  std::string options, last;
  int table = -1;
  for (const BodyDef& body : scene.bodies) {
    if (table >= 0 && body.table == last) continue;  // a piece or a copy
    last = body.table;
    const nlohmann::ordered_json::json_pointer own(fmt::format("/body/{}/solver/iterations", ++table));
    if (json.contains(own))
      options += fmt::format(" --set body.{}.solver.iterations={}", body.table, 3 * body.solver.settings.iterations);
  }
  if (options.empty())
    options = fmt::format(" --set solver.iterations={}", 3 * scene.bodies.front().solver.settings.iterations);
  return {bodies_meant_unsolved(scene), options.substr(1) + " brings them nearer"};
}

}  // namespace supple
