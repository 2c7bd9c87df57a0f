// Measures what drawing costs, stage by stage, without the rest of a film: a scene is simulated for a moment, and its
// frames are drawn over and over. The first numbers are of frames drawn as a film draws them; those by stage wait for
// the rasteriser after each stage, and add up to a little more.
//   supple_render_study SCENE PNG [FRAMES] [KEY=VALUE ...]      (PNG: where the last picture goes)
#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstdlib>
#include <map>

#include "app/bench/subject.h"
#include "base/timing.h"
#include "base/trace.h"
#include "film/pictures/camera.h"
#include "film/pictures/film_stage.h"
#include "film/plan/shipped_files.h"
#include "output/files/png_file.h"
#include "render/renderer.h"
#include "scene/reading/scene_reader.h"

using namespace supple;

namespace {

constexpr int repeats = 100;

double cpu_ms() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto ms = [](const timeval& t) { return 1e3 * double(t.tv_sec) + 1e-3 * double(t.tv_usec); };
  return ms(usage.ru_utime) + ms(usage.ru_stime);
}

double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + std::ptrdiff_t(values.size() / 2), values.end());
  return values[values.size() / 2];
}

struct Take {
  Stage stage;
  std::vector<DrawList> lists;  // of consecutive frames
};

Take simulate(const std::filesystem::path& path, int frames, const std::vector<std::string>& settings) {
  const SceneDef scene = load_scene(path, assets_folder(), settings);
  World world(scene, assemble(scene));
  Threads threads(2);
  world.start(scenes_own_solver(), &threads);
  const std::vector<Body>& bodies = world.bodies();
  const CollisionSet& set = world.colliders();
  std::vector<DrawnBody> drawn = drawn_bodies(bodies);
  const std::vector<Skin> colliders = collider_skins(set.scene_colliders, bodies);
  Take take;
  const Stage fine = make_stage(scene, bodies, drawn, set.scene_colliders, colliders, text_font());
  const Camera camera = camera_at(scene, fine, 0);
  fit_to_cameras(drawn, bodies, {camera}, scene.output.height);
  take.stage = make_stage(scene, bodies, drawn, set.scene_colliders, colliders, text_font());
  for (int frame = 0; frame < frames; ++frame) {
    world.play(frame);
    if (frame + 4 < frames) continue;
    DrawList list;
    list.camera = camera;
    for (std::size_t b = 0; b < bodies.size(); ++b)
      list.positions.push_back(skin_positions(drawn[b], bodies[b].description.mesh,
                                              in_input_order(world.body(b).model(), world.body(b).state().x)));
    add_colliders(set.scene_colliders, colliders, (frame + 1) / scene.fps, list);
    take.lists.push_back(std::move(list));
  }
  return take;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return 2;
  std::vector<std::string> settings;
  int frames = 20;
  for (int i = 3; i < argc; ++i) {
    if (std::string(argv[i]).find('=') == std::string::npos) {
      frames = std::atoi(argv[i]);
    } else {
      settings.emplace_back(argv[i]);
    }
  }
  const Take take = simulate(argv[1], frames, settings);
  std::size_t triangles = 0;
  for (const DrawMesh& mesh : take.stage.meshes) triangles += mesh.triangles.size() / 3;
  Renderer renderer(take.stage, GlChoice::osmesa, shaders_folder());
  Image image;
  std::vector<double> wall, cpu;
  for (int i = 0; i < repeats; ++i) {
    const Stopwatch watch;
    const double before = cpu_ms();
    image = renderer.draw(take.lists[std::size_t(i) % take.lists.size()]);
    wall.push_back(watch.elapsed_ms());
    cpu.push_back(cpu_ms() - before);
  }
  fmt::print("{} triangles, {}x{}: wall {:.1f} ms (least {:.1f}), cores {:.1f} ms (least {:.1f})\n", triangles,
             image.width, image.height, median(wall), *std::ranges::min_element(wall), median(cpu),
             *std::ranges::min_element(cpu));
  start_trace();
  for (int i = 0; i < repeats; ++i) image = renderer.draw(take.lists[std::size_t(i) % take.lists.size()]);
  std::map<std::string, std::vector<double>> stages;
  for (const ThreadTrace& thread : stop_trace()) {
    for (const TraceEvent& event : thread.events)
      stages[event.name].push_back(1e-6 * double(event.end_ns - event.begin_ns));
  }
  for (auto& [name, times] : stages)
    fmt::print("  {:<16}{:8.2f} ms (least {:.2f})\n", name, median(times), *std::ranges::min_element(times));
  write_png(argv[2], image.width, image.height, image.rgb);
}
