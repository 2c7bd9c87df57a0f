// Says what the air of a scene has to do with a body, by the definitions of both. Not here: forces (sim/air/).
#pragma once

#include <optional>

#include "scene/definition/scene_def.h"
#include "sim/model/air_inputs.h"

namespace supple {

// Returns what a step's inputs have for a body: drag where there is air, on cloth and on solids that ask for it, and
// the gas that the body holds. Nothing where there is neither drag nor gas.
inline std::optional<PartAir> air_of(const SceneDef& scene, const BodyDef& body) {
  PartAir air;
  if (scene.wind) air.drag = body.drag.value_or(body.cloth ? usual_drag : DragCoefficients{});
  air.gas = body.pressure;
  if (!air.drag.act() && !air.gas) return std::nullopt;
  return air;
}

}  // namespace supple
