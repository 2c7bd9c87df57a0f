// Counts, in every frame, where layers of cloth pass through each other, through themselves or through soft bodies, and
// measures what the contact of layers costs.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "app/bench/comparison.h"
#include "app/bench/sections.h"
#include "app/bench/touching_film.h"
#include "app/bench/touching_tables.h"
#include "app/bench/world_crossings.h"
#include "film/plan/shipped_files.h"
#include "scene/reading/scene_reader.h"

namespace supple {
namespace {

constexpr int creep_frames = 30;  // the last ones, in which creep is measured

// Returns the text of ten square cloths that fall on a ball, one above the other.
std::string ten_layers() {
  std::string text = "frames = 120\n";
  for (int i = 0; i < 10; ++i) {
    text += fmt::format(
        "[[body]]\nname = \"layer-{}\"\ncloth = {{ extent = [0.6, 0.6], cells = [24, 24] }}\nmaterial = \"cotton\"\n"
        "turn_deg = [-90, {}, 0]\nposition = [0, {:g}, 0]\n",
        i + 1, 9 * i, 0.45 + 0.03 * i);
  }
  return text + ground_text(0.5) +
         "[[collider]]\nname = \"ball\"\nshape = { sphere = { radius = 0.2 } }\nposition = [0, 0.2, 0]\n"
         "friction = 0.3\nthickness = 0.004\n";
}

// Returns the text of a cloth that is held by its upper corners, at which a soft ball flies by its own size in a frame.
std::string hit_by_a_soft_ball() {
  return "frames = 60\n"
         "[[body]]\nname = \"cloth\"\ncloth = { extent = [1, 1], cells = [40, 40] }\nmaterial = \"cotton\"\n"
         "position = [0, 0.5, 0]\n"
         "[[body.handles]]\nname = \"left\"\nselect = { box = [[0, 1, 0], [0, 1, 1]] }\n"
         "[[body.handles]]\nname = \"right\"\nselect = { box = [[1, 1, 0], [1, 1, 1]] }\n"
         "[[body]]\nname = \"ball\"\nshape = \"shapes/sphere.toml\"\nsize = 0.2\nvertices = 500\nmaterial = "
         "\"rubber\"\n"
         "position = [0, 1.1, 0.5]\nvelocity = [0, 0, -6]\n";
}

// Holds what is seen of the layers of a film.
struct LayersSeen {
  int bodies = 0, vertices = 0, frames = 0;
  int crossed_frames = 0;             // frames with crossings other than at sharp folds
  std::int64_t most = 0, at_end = 0;  // of these crossings
  std::int64_t most_beside = 0;       // of crossings at sharp folds
  double ms = 0;                      // of the steps of a frame, mean
  double kinetic = 0;                 // energy at the end, over its largest
  double creep = 0;                   // the longest way of a vertex in the last frames, over its body's size
  bool failed = false;
};

// Returns the longest way of a vertex from the places `before`, over the size of its body.
double creep_since(TouchingFilm& film, const std::vector<Positions>& before) {
  double most = 0;
  for (std::size_t b = 0; b < before.size(); ++b)
    most = std::max(most, (film.places(b) - before[b]).rowwise().norm().maxCoeff() / film.size(b));
  return most;
}

LayersSeen watch_layers(const SceneDef& scene, Threads& threads) {
  LayersSeen seen;
  seen.frames = scene.frames;
  TouchingFilm film(scene, assemble(scene), threads);
  WorldCrossings crossings(film);
  seen.bodies = static_cast<int>(film.world().size());
  for (std::size_t b = 0; b < film.world().size(); ++b) seen.vertices += film.world().body(b).model().vertices;
  double most_kinetic = 0;
  std::vector<Positions> before;
  while (film.frames() < scene.frames) {
    if (!film.play()) {
      seen.failed = true;
      return seen;
    }
    seen.ms += film.work().ms / scene.frames;
    const EdgeCrossings::Count count = crossings.count();
    seen.at_end = count.apart;
    seen.most_beside = std::max(seen.most_beside, count.beside);
    seen.crossed_frames += seen.at_end > 0;
    seen.most = std::max(seen.most, seen.at_end);
    most_kinetic = std::max(most_kinetic, film.kinetic_energy());
    if (film.frames() != scene.frames - creep_frames) continue;
    for (std::size_t b = 0; b < film.world().size(); ++b) before.push_back(film.places(b));
  }
  seen.kinetic = film.kinetic_energy() / most_kinetic;
  seen.creep = creep_since(film, before);
  return seen;
}

// Returns the time of a frame where no body meets another one or itself [ms].
double ms_alone(SceneDef scene, Threads& threads) {
  for (BodyDef& body : scene.bodies) {
    body.contact.meets = std::vector<std::string>();
    body.contact.self = false;
  }
  const LayersSeen seen = watch_layers(scene, threads);
  return seen.failed ? std::nan("") : seen.ms;
}

std::vector<std::string> layers_row(const std::string& name, const SceneDef& scene, bool comes_to_rest,
                                    const BenchSetting& setting) {
  say_doing(setting, name);
  const LayersSeen seen = watch_layers(scene, *setting.threads);
  if (seen.failed) return {name, "failed"};
  say_doing(setting, fmt::format("{}, each body alone", name));
  const double alone = ms_alone(scene, *setting.threads);
  return {name,
          std::to_string(seen.bodies),
          std::to_string(seen.vertices),
          std::to_string(seen.frames),
          std::to_string(seen.crossed_frames),
          "0",
          std::to_string(seen.most),
          std::to_string(seen.at_end),
          std::to_string(seen.most_beside),
          number_text(seen.ms),
          number_text(alone),
          number_text(seen.ms / alone),
          "3",
          number_text(seen.kinetic),
          comes_to_rest ? "1e-4" : "",
          number_text(seen.creep),
          comes_to_rest ? "1e-3" : ""};
}

}  // namespace

ReportTable layers_table(const BenchSetting& setting) {
  ReportTable table{"touching-layers", "Layers of cloth"};
  table.note = fmt::format(
      "A crossing is an edge that passes through a triangle of the same or another body at the end of a frame. Where "
      "an "
      "edge of the mesh joins the two, it is at a sharp fold, and in a column of its own; an edge that shares a vertex "
      "with the triangle does not count. The time is that of all steps of a frame, with finding who may touch "
      "whom; each body alone meets neither others nor itself. The creep is the longest way of a vertex in the last {} "
      "frames, over its body's size. The ten layers have 25 x 25 vertices each and fall on a hard ball; the soft ball "
      "flies by its own size in a frame at a cloth that is held by two corners.",
      creep_frames);
  table.columns = {"scene",
                   "bodies",
                   "vertices",
                   "frames",
                   "frames with crossings",
                   "crossed, aim",
                   "crossings, most",
                   "crossings at the end",
                   "at sharp folds, most",
                   "a frame [ms]",
                   "each body alone [ms]",
                   "over alone",
                   "over alone, aim: below",
                   "kinetic energy at the end over its largest",
                   "at rest, aim: below",
                   "creep at the end",
                   "creep, aim: below"};
  const auto add = [&](const std::string& name, const SceneDef& scene, bool comes_to_rest) {
    std::vector<std::string> row = layers_row(name, scene, comes_to_rest, setting);
    row.resize(table.columns.size());
    table.rows.push_back(std::move(row));
  };
  for (const char* const name : {"towels", "dress", "curtain", "cloth-on-bunny"})
    add(name, load_scene(scene_file(name), assets_folder(), {}), std::string(name) == "towels");
  add("ten layers on a ball", scene_of_text(ten_layers(), "layers"), false);
  add("hit by a soft ball", scene_of_text(hit_by_a_soft_ball(), "layers"), false);
  return table;
}

}  // namespace supple
