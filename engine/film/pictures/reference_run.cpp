#include "film/pictures/reference_run.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "base/text.h"
#include "output/files/obj_file.h"
#include "output/run/run_record.h"

namespace supple {

ReferenceRun::ReferenceRun(const std::filesystem::path& folder, const std::vector<Body>& bodies) : folder_(folder) {
  const RunRecord run = read_run(folder);
  std::vector<std::string> there;
  if (!run.rows.empty())
    for (const BodyRow& row : run.rows.front().bodies) there.push_back(row.name);
  for (const Body& body : bodies) {
    const std::string& name = body.def.name;
    if (!there.empty() && std::ranges::find(there, name) == there.end())
      throw InputError(folder.string(), fmt::format("that run has no body '{}' (it has {}), so that the two cannot be "
                                                    "compared; another run of this scene can be{}",
                                                    name, word_list(there), did_you_mean(name, there)));
    motion_.emplace_back(run.motion(body.def.name));
    origin_.push_back(motion_origin(body.description.mesh.rest));
    const auto vertices = static_cast<int>(body.description.mesh.rest.rows());
    if (motion_.back().points() == vertices) continue;
    throw InputError(folder.string(), fmt::format("body '{}' has {} vertices there and {} here, so that the two cannot "
                                                  "be compared",
                                                  body.def.name, motion_.back().points(), vertices));
  }
}

Positions ReferenceRun::at(std::size_t body, int frame) {
  if (frame >= motion_[body].frames())
    throw InputError(folder_.string(), fmt::format("has {} frames, and frame {} is needed for the comparison",
                                                   motion_[body].frames(), frame));
  return motion_[body].frame(frame).rowwise() + origin_[body].transpose();
}

void check_references(const SceneDef& scene, const std::vector<Body>& bodies, int last_frame) {
  const auto check = [&](const std::filesystem::path& folder) {
    if (folder.empty()) return;
    ReferenceRun run(folder, bodies);
    for (std::size_t b = 0; b < bodies.size(); ++b) run.at(b, last_frame);
  };
  if (scene.field.quantity == FieldQuantity::distance) check(scene.field.reference);
  check(scene.look.ghost);
}

}  // namespace supple
