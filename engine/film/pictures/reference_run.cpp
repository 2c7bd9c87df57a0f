#include "film/pictures/reference_run.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/text.h"
#include "film/plan/run_plan.h"
#include "output/files/obj_file.h"
#include "output/run/run_record.h"

namespace supple {

namespace {

int frames_later(const SceneDef& scene, const RunRecord& run) {
  const double start = time_in_run(run, -1), frame = time_in_run(run, 0) - start, own = 1 / scene.fps;
  const bool same_rate = std::abs(frame - own) < 1e-6 * own;
  return same_rate ? static_cast<int>(std::lround((scene.time_at_start() - start) * scene.fps)) : 0;
}

}  // namespace

ReferenceRun::ReferenceRun(const std::filesystem::path& folder, const SceneDef& scene, const std::vector<Body>& bodies)
    : folder_(folder) {
  const RunRecord run = read_run(folder);
  later_ = frames_later(scene, run);
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
  return motion_[body].frame(std::clamp(frame + later_, 0, motion_[body].frames() - 1)).rowwise() +
         origin_[body].transpose();
}

void ReferenceRun::require(int frame) const {
  const int there = frame + later_;
  if (there < 0)
    throw InputError(folder_.string(),
                     fmt::format("goes on from an earlier run and starts {} frames after the frame {} that would be "
                                 "compared with it",
                                 -there, frame));
  for (const PointCacheReader& motion : motion_) {
    if (there >= motion.frames())
      throw InputError(folder_.string(),
                       fmt::format("has {} frames, and frame {} is needed for the comparison", motion.frames(), there));
  }
}

void check_references(const SceneDef& scene, const std::vector<Body>& bodies, int first_frame, int last_frame) {
  const auto check = [&](const std::filesystem::path& folder) {
    if (folder.empty()) return;
    const ReferenceRun run(folder, scene, bodies);
    run.require(first_frame);
    run.require(last_frame);
  };
  if (scene.field.quantity == FieldQuantity::distance) check(scene.field.reference);
  check(scene.look.ghost);
  if (!scene.look.ghost.empty() && scene.output.samples < 2)
    throw InputError("look.ghost", "a ghost takes every second sample of a pixel: output.samples must be 2 or more");
}

}  // namespace supple
