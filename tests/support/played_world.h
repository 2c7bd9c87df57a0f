// Makes worlds of scenes that are written in a test.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <string>
#include <vector>

#include "base/threads.h"
#include "baselines/make_rule.h"
#include "scene/building/assemble.h"
#include "support/places.h"
#include "support/scene_text.h"
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

// A scene's world with threads of its own. count: of the threads.
struct PlayedWorld {
  explicit PlayedWorld(const std::string& text, int count = 1)
      : threads(count), world(scene_of(text), assemble(scene_of(text))) {
    world.start({make_rule, settings_of}, &threads);
  }
  void play(int first, int end) {
    for (int frame = first; frame < end; ++frame) ASSERT_TRUE(world.play(frame)) << frame;
  }
  // Returns the positions of a body in the order of its mesh, n x 3 [m].
  Positions places(std::size_t body) const {
    return in_input_order(world.body(body).model(), world.body(body).state().x);
  }

  Threads threads;
  World world;
};

}  // namespace supple::test
