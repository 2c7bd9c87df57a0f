#include <fmt/core.h>

#include <algorithm>

#include "app/summary.h"
#include "base/text.h"
#include "base/timing.h"
#include "film/plan/shipped_files.h"
#include "scene/building/assemble.h"
#include "scene/replay/script.h"
#include "sim/model/model_values.h"

namespace supple {
namespace {

// Returns the least time of three factorisations on this machine [ms].
double cost_of_factor(const Body& body) {
  Model model = build_model(body.description);
  ModelValues values(model, body.description);
  double least = 0;
  for (int repeat = 0; repeat < 3; ++repeat) {
    const Stopwatch watch;
    values.set(model, body.description);
    least = repeat == 0 ? watch.elapsed_ms() : std::min(least, watch.elapsed_ms());
  }
  return least;
}

}  // namespace

std::string live_summary(const SceneSource& source) {
  const Script script = Script::load(source, assets_folder(), {});
  const std::vector<LiveKey> live = script.live();
  std::size_t widest = 0;
  for (const LiveKey& key : live) widest = std::max(widest, key.key.path.size());
  std::string text = fmt::format("{:<{}}  {:<14} {:<10} now; what is allowed; what a change asks for\n", "path", widest,
                                 "type", "unit");
  for (const auto& [key, cost] : live) {
    const std::string value = key.type == "table" ? "" : printable(key.value) + "; ";
    const char* asks = cost.text();
    text += fmt::format("{:<{}}  {:<14} {:<10} {}{}{}{}\n", key.path, widest, key.type, key.unit, value, key.allowed,
                        *asks == '\0' ? "" : "; ", asks);
  }
  text +=
      "\nWhole tables and lists may change too, such as a body's material, a handle's keys or the parts of a shape.\n"
      "Any body may have a solver of its own (body.NAME.solver.iterations).\n";
  for (const Body& body : assemble(script.scene()))
    text += fmt::format("A new factor of '{}' takes {:.1f} ms here.\n", body.def.name, cost_of_factor(body));
  return text;
}

}  // namespace supple
