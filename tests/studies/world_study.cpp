// Prints how long each frame of a scene takes in a World, on one thread [ms]: what python/studies/cost.py compares
// with.
//
//   supple_world_study SCENE FRAMES
#include <fmt/core.h>

#include <cstdlib>

#include "app/solvers.h"
#include "base/timing.h"
#include "base/user_cache.h"
#include "film/plan/shipped_files.h"
#include "world/world.h"

int main(int count, char** arguments) {
  using namespace supple;
  if (count != 3) return 2;
  Script script = Script::load(scene_file(arguments[1]), assets_folder(), {});
  std::vector<Body> bodies = assemble(script.scene(), {UserCache::of_user(), {}});
  World world(std::move(script), std::move(bodies));
  Threads threads(1);
  world.start(all_solvers().steps, &threads);
  for (int frame = 0; frame < std::atoi(arguments[2]); ++frame) {
    const Stopwatch watch;
    if (!world.play(frame)) return 1;
    fmt::print("{:.4f}\n", watch.elapsed_ms());
  }
}
