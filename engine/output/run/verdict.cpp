#include "output/run/verdict.h"

#include <fmt/core.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include "output/run/row_tally.h"

namespace supple {
namespace {

struct StageTime {
  const char* name;
  double ms;
  const char* remedies;
};

}  // namespace

FrameWork work_of(const std::vector<FrameRow>& rows, double encoding) { return RowTally(rows).work(encoding); }

FrameWork work_of(const ZoneProfile& profile) {
  FrameWork work;
  const int first = profile.run.frames > 1 ? 1 : 0;
  const std::pair<const char*, double FrameWork::*> zones[] = {
      {"frame/step", &FrameWork::solving},      {"frame/change", &FrameWork::solving},
      {"frame/draw list", &FrameWork::drawing}, {"render", &FrameWork::drawing},
      {"compress", &FrameWork::compressing},    {"write", &FrameWork::compressing}};
  for (const ZoneTimes& zone : profile.zones) {
    const auto at = std::ranges::find_if(zones, [&zone](const auto& known) { return zone.path == known.first; });
    if (at == std::end(zones)) continue;
    for (const std::vector<double>& frames : zone.ms) {
      for (int frame = first; frame < profile.run.frames; ++frame)
        work.*at->second += frames[frame] / (profile.repeats * (profile.run.frames - first));
    }
  }
  return work;
}

std::string verdict(const FrameWork& work) {
  const StageTime stages[] = {
      {"solving", work.solving, "a coarser mesh, fewer iterations or fewer substeps help"},
      {"drawing", work.drawing, "fewer samples, a smaller size or --no-images help"},
      {"compressing", work.compressing, "a smaller size, or --film-only, which leaves no files of the frames, helps"},
      {"encoding", work.encoding, "a smaller size or --no-video helps"}};
  double sum = 0;
  std::string list;
  for (const StageTime& stage : stages) {
    sum += stage.ms;
    if (stage.ms > 0) list += fmt::format("{}{} {:.1f} ms", list.empty() ? "" : ", ", stage.name, stage.ms);
  }
  if (sum <= 0) return "";
  const StageTime& dearest = *std::ranges::max_element(stages, {}, &StageTime::ms);
  return fmt::format("{} is {:.0f} % of the work for a frame ({}): {}", dearest.name, 100 * dearest.ms / sum, list,
                     dearest.remedies);
}

}  // namespace supple
