// Makes worlds of scenes that are written in a test.
#pragma once

#include <string>
#include <vector>

#include "baselines/make_rule.h"
#include "scene/building/assemble.h"
#include "support/places.h"
#include "world/world.h"

namespace supple::test {

// A bar that is held at one end and a cube beside it, in two substeps a frame.
inline const std::string bar_and_cube = R"(substeps = 2
[[body]]
name = "bar"
box = { extent = [0.4, 0.1, 0.1], cells = [6, 2, 2] }
position = [0, 0.3, 0]
material = { model = "neo-hookean", mu = 10000, lambda = 20000 }
[[body.handles]]
name = "end"
select = { box = [[0, 0, 0], [0.01, 1, 1]] }
[[body]]
name = "cube"
box = { extent = [0.1, 0.1, 0.1], cells = [2, 2, 2] }
position = [0.5, 0.3, 0]
material = { model = "neo-hookean", mu = 10000, lambda = 20000 }
)";

// Returns a world before its first frame.
inline World world_of(const SceneSource& source, const std::vector<std::string>& settings = {}) {
  Script script = Script::load(source, assets, settings);
  std::vector<Body> bodies = assemble(script.scene());
  World world(std::move(script), std::move(bodies));
  world.start({make_rule, settings_of}, nullptr);
  return world;
}

}  // namespace supple::test
