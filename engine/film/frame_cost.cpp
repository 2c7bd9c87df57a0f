#include "film/frame_cost.h"

#include <fmt/core.h>

namespace supple {

FrameCost cost_of_frames(const SceneDef& scene, Body& body, Model& model, const CollisionSet& set,
                         const Solvers& solvers, Threads& threads, int frames) {
  DrivenBody driver(scene, body, model, set, solvers, &threads);
  FrameCost cost;
  int steps = 0;
  for (int frame = 0; frame < frames && cost.failure.empty(); ++frame) {
    double ms = 0;
    driver.make_frame(frame, [&](const StepReport& report) {
      if (report.failed) cost.failure = fmt::format("step {} fails: {}", steps, report.failure.what);
      cost.touched = cost.touched || report.contacts.touching > 0;
      ms += report.step_ms;
      ++steps;
    });
    if (cost.failure.empty()) cost.frame_ms.push_back(ms);
  }
  cost.state = driver.state();
  return cost;
}

}  // namespace supple
