#include <fmt/core.h>

#include <optional>

#include "app/sweep/merge.h"
#include "app/sweep/point.h"
#include "app/sweep/run_points.h"
#include "app/verbs.h"
#include "base/console.h"
#include "base/error.h"
#include "base/text.h"
#include "film/plan/shipped_files.h"
#include "scene/replay/script.h"

namespace supple {
namespace {

// Describes a sweep as the command line asks for it.
struct SweepOptions {
  SweepRequest request;
  std::string out;
  int frames = 0;
  long long seed = -1;
  int jobs = 0;
  std::optional<std::size_t> index;
  bool list = false, count = false, merge = false, again = false, images = false, no_images = false;
};

SweepRequest request_of(const SweepOptions& options) {
  SweepRequest request = options.request;
  request.file = scene_file(request.scene);
  if (options.frames > 0) request.settings.push_back(fmt::format("frames={}", options.frames));
  if (options.seed >= 0) request.settings.push_back(fmt::format("seed={}", options.seed));
  request.sweep = load_sweep(request.file, assets_folder(), request.settings);
  const SceneDef scene = Script::load(request.file, assets_folder(), request.settings).scene();
  request.name = scene.name;
  request.title = scene.title;
  request.out =
      options.out.empty() ? std::filesystem::path("out") / (scene.name + "-sweep") : std::filesystem::path(options.out);
  if (options.images) request.pictures = FilmPictures::all;
  if (options.no_images) request.pictures = FilmPictures::none;
  return request;
}

void list_points(const SweepDef& sweep) {
  for (std::size_t point = 0; point < sweep.points(); ++point) {
    std::string line = std::to_string(point);
    const std::vector<std::string> values = sweep.values(point);
    for (std::size_t a = 0; a < values.size(); ++a) line += fmt::format("  {}={}", sweep.axes[a].path, values[a]);
    say(stdout, line + "\n");
  }
}

int sweep(const SweepOptions& options, const std::vector<std::string>& command) {
  const SweepRequest request = request_of(options);
  const std::size_t points = request.sweep.points();
  if (options.count) {
    say(stdout, fmt::format("{}\n", points));
    return 0;
  }
  if (options.list) {
    list_points(request.sweep);
    return 0;
  }
  check_folder(request);
  if (options.merge) return merge_points(request);
  if (!options.index) return run_points(request, options.jobs, options.again);
  if (*options.index >= points)
    throw InputError(fmt::format("--index {}", *options.index),
                     points == 1 ? std::string("the sweep has one point, 0")
                                 : fmt::format("the sweep has {} points, 0 to {}", points, points - 1));
  return run_point(request, *options.index, command);
}

void add_options(Verb& verb, SweepOptions& options) {
  SweepRequest& request = options.request;
  verb.option("SCENE", request.scene, "scene file with a [sweep] table, or the name of one that ships").required();
  Options what = verb.at_most_one_of("What to do", "one of these; without any, as --jobs");
  what.option("--jobs", options.jobs, "run what is not done, so many points at a time [cores / threads]; then merge")
      .between(1, 1024);
  what.option("--index", options.index, "run this point alone, done or not; counts from 0")
      .between(std::size_t(0), most_sweep_points);
  what.flag("--merge", options.merge, "make the tables, the contact sheet and the page of what has run");
  what.flag("--list", options.list, "the points and their values, a line each");
  what.flag("--count", options.count, "how many points there are");
  verb.flag("--again", options.again, "run points that are done once more");
  verb.option("--out", options.out, "folder for the results [out/NAME-sweep]");
  verb.option("--frames", options.frames, "length of the films, over the scene's").between(1, 1000000);
  verb.option("--threads", request.threads, "threads of each point; results do not depend on it")
      .between(1, 256)
      .shows_default();
  verb.option("--set", request.settings, "path=value over the scene's, for all points; may be repeated").repeatable();
  verb.option("--seed", options.seed, "of random start states, over the scene's").between(0, 2000000000);
  verb.option("--error-every", request.error_every, "measure the error of equation 12 every N frames (slow)")
      .between(1, 1000000);
  const Option images = verb.flag("--images", options.images, "film every point; otherwise the last frame is drawn");
  verb.flag("--no-images", options.no_images, "simulate only").excludes(images);
  verb.option("--gl", request.gl, word_list(all_names<GlChoice>())).one_of(all_names<GlChoice>());
  verb.flag(
      "--no-cache", [&request] { request.cache = false; },
      "make meshes and skins anew; keep none in the user's cache folder");
  verb.flag("--quiet", request.quiet, "say nothing but errors");
}

}  // namespace

void add_sweep(CommandLine& line) {
  auto options = std::make_shared<SweepOptions>();
  Verb verb = line.verb("sweep", "Run a scene with other values, point by point, and compare.");
  verb.footer(
      "Example: supple sweep pulled-bar\n"
      "         supple sweep squirrel --set 'sweep.values.solver.iterations=[5, 10, 20]' --frames 60\n"
      "Leaves points/NNNN/ (a run each), sweep.csv, times.csv, contact-sheet.png and index.html in out/NAME-sweep.");
  add_options(verb, *options);
  verb.runs([options, words = line.words()] { return sweep(*options, words); });
}

}  // namespace supple
