#include "film/frame_cost.h"

#include <fmt/core.h>

namespace supple {

std::vector<FrameCost> cost_of_frames(World& world, int frames) {
  std::vector<FrameCost> costs(world.size());
  for (int frame = 0; frame < frames; ++frame) {
    std::vector<double> ms(world.size());
    const bool whole = world.play(frame, {{}, [&](std::size_t body, int substep) {
                                            const StepReport& report = world.body(body).report();
                                            const int step = frame * world.scene().substeps + substep;
                                            if (report.failed)
                                              costs[body].failure =
                                                  fmt::format("step {} fails: {}", step, report.failure.what);
                                            costs[body].touched |= report.contacts.touching > 0;
                                            ms[body] += report.step_ms;
                                          }});
    if (!whole) break;
    for (std::size_t b = 0; b < ms.size(); ++b) costs[b].frame_ms.push_back(ms[b]);
  }
  return costs;
}

}  // namespace supple
