// Plays a scene or replay. Prints for each frame its number, the hash of its state and the height of the lowest vertex
// of the first body.
//
//   play_a_scene /opt/supple/share/supple/assets/scenes/rolling.toml /opt/supple/share/supple/assets
#include <base/error.h>
#include <base/threads.h>
#include <baselines/make_rule.h>
#include <world/world.h>

#include <cinttypes>
#include <cstdio>

int main(int count, char** arguments) {
  using namespace supple;

  if (count != 3) {
    std::fprintf(stderr,
                 "play_a_scene SCENE ASSETS: the second is the folder in which scenes look for shapes and meshes\n");
    return 2;
  }
  try {
    Script script = Script::load(std::filesystem::path(arguments[1]), arguments[2], {});
    std::vector<Body> bodies = assemble(script.scene());
    Threads threads(2);  // outlives the world
    World world(std::move(script), std::move(bodies));
    world.start({make_rule, settings_of}, &threads);  // with all solvers that a scene can name
    for (int frame = 0; frame < world.scene().frames; ++frame) {
      if (!world.play(frame)) throw RunError("a step of frame " + std::to_string(frame) + " failed");
      const double lowest = world.body(0).state().x.col(1).minCoeff();
      std::printf("%d %016" PRIx64 " %.4f\n", frame, world.hash(), lowest);
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
