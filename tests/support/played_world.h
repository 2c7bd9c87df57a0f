// Makes worlds of scenes that are written in a test.
#pragma once

#include "baselines/make_rule.h"
#include "scene/building/assemble.h"
#include "support/places.h"
#include "world/world.h"

namespace supple::test {

// Returns a world before its first frame.
inline World world_of(const SceneSource& source, const std::vector<std::string>& settings = {}) {
  Script script = Script::load(source, assets, settings);
  std::vector<Body> bodies = assemble(script.scene());
  World world(std::move(script), std::move(bodies));
  world.start({make_rule, settings_of}, nullptr);
  return world;
}

}  // namespace supple::test
