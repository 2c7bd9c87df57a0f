// Measures how deep bodies come into themselves, and what it costs bodies that do not touch themselves to be asked
// whether they do.
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

constexpr int plays = 3, asked_frames = 60;  // of scenes whose bodies do not touch themselves

// Returns the text of a bunny that leans back and is held below its neck, so soft that its ears fall on its back.
std::string falling_ears() {
  return "frames = 90\n"
         "[[body]]\nname = \"bunny\"\nshape = \"shapes/bunny.toml\"\nsize = 0.3\nvertices = 4000\ndensity = 1000\n"
         "turn_deg = [-40, 0, 0]\nmaterial = { model = \"stable-neo-hookean\", young = 4e3, poisson = 0.4 }\n"
         "[[body.handles]]\nname = \"body\"\nselect = { box = [[0, 0, 0], [1, 0.5, 1]] }\n";
}

// Returns the text of a cotton sheet that is held by one half; the end of the other is led over it and let go.
std::string folded_sheet() {
  return "frames = 90\n"
         "[[body]]\nname = \"sheet\"\ncloth = { extent = [0.8, 0.4], cells = [48, 24] }\nmaterial = \"cotton\"\n"
         "position = [0, 0.5, 0]\nturn_deg = [90, 0, 0]\n"
         "[[body.handles]]\nname = \"table\"\nselect = { box = [[0, 0, 0], [0.45, 1, 1]] }\n"
         "[[body.handles]]\nname = \"end\"\nselect = { box = [[0.98, 0, 0], [1, 1, 1]] }\nuntil = 0.6\n"
         "stiffness = 300\nkeys = [{ t = 0 }, { t = 0.3, move = [-0.35, 0.3, 0] },\n"
         "{ t = 0.6, move = [-0.65, 0.1, 0] }]\n";
}

// Holds what is seen of a film of one body that touches itself.
struct SelfSeen {
  int vertices = 0, contacts = 0, touching_frames = 0, crossed_frames = 0;
  std::vector<double> depths;  // by frame, over the size
  double ms = 0, trials = 0;   // of a frame's steps, mean; an iteration
  bool failed = false;
};

SelfSeen watch_self(const SceneDef& scene, bool is_cloth, Threads& threads) {
  SelfSeen seen;
  TouchingFilm film(scene, assemble(scene), threads);
  WorldCrossings crossings(film);
  seen.vertices = film.world().body(0).model().vertices;
  int iterations = 0, trials = 0;
  while (film.frames() < scene.frames) {
    if (!film.play()) {
      seen.failed = true;
      return seen;
    }
    const TouchingWork& work = film.work();
    seen.ms += work.ms / scene.frames;
    iterations += work.iterations;
    trials += work.trials;
    seen.contacts = std::max(seen.contacts, work.contacts);
    seen.touching_frames += work.contacts > 0;
    if (is_cloth) seen.crossed_frames += crossings.count().apart > 0;
    seen.depths.insert(seen.depths.end(), work.depths.begin(), work.depths.end());
  }
  seen.trials = double(trials) / std::max(1, iterations);
  return seen;
}

// Holds what is seen of a scene that is played with the question whether bodies touch themselves, and without it.
struct AskedSeen {
  int bodies = 0, vertices = 0;
  double ms = 0, unasked_ms = 0;  // of a frame's steps, mean
  bool same_bits = true;          // of the last frame, in all plays
  bool failed = false;
};

// Plays some frames, and keeps the least time of each. Returns the hash of the last frame's state.
std::uint64_t play_timed(const SceneDef& scene, std::vector<double>& least_ms, AskedSeen& seen, Threads& threads) {
  TouchingFilm film(scene, assemble(scene), threads);
  seen.bodies = static_cast<int>(film.world().size());
  seen.vertices = 0;
  for (std::size_t b = 0; b < film.world().size(); ++b) seen.vertices += film.world().body(b).model().vertices;
  for (double& ms : least_ms) {
    if (!film.play()) {
      seen.failed = true;
      return 0;
    }
    ms = std::min(ms, film.work().ms);
  }
  return film.world().hash();
}

AskedSeen watch_asked(const SceneDef& scene, Threads& threads) {
  SceneDef unasked = scene;
  for (BodyDef& body : unasked.bodies) body.contact.self = false;
  const auto frames = std::size_t(std::min(scene.frames, asked_frames));
  std::vector<double> ms(frames, 1e300), unasked_ms(frames, 1e300);
  AskedSeen seen;
  for (int play = 0; play < plays && !seen.failed; ++play) {
    const std::uint64_t hash = play_timed(scene, ms, seen, threads);
    seen.same_bits &= play_timed(unasked, unasked_ms, seen, threads) == hash;
  }
  for (const double frame : ms) seen.ms += frame / double(frames);
  for (const double frame : unasked_ms) seen.unasked_ms += frame / double(frames);
  return seen;
}

}  // namespace

ReportTable self_table(const BenchSetting& setting) {
  ReportTable table{"touching-self", "Bodies that touch themselves"};
  table.note =
      "The bar of coil is twisted until it winds around itself; a soft bunny that leans back is held below its neck, "
      "and its ears fall on its back; one end of a sheet of cotton is led over the half that is held, and let go. "
      "Contacts are points that touch the body itself at the end of a frame; depths are the deepest of each frame in "
      "which there are any, over the body's size. Crossings are those of the table of layers, and are counted for "
      "cloth.";
  table.columns = {"film",
                   "vertices",
                   "frames",
                   "frames that touch",
                   "contacts, most",
                   "depth, 99th percentile [%]",
                   "depth, aim: below [%]",
                   "deepest [%]",
                   "frames with crossings",
                   "crossed, aim",
                   "trials an iteration",
                   "trials, aim: below",
                   "a frame [ms]"};
  const auto add = [&](const std::string& name, const SceneDef& scene, bool is_cloth) {
    say_doing(setting, name);
    const SelfSeen seen = watch_self(scene, is_cloth, *setting.threads);
    std::vector<std::string> row = {name, "failed"};
    if (!seen.failed) {
      row = {name,
             std::to_string(seen.vertices),
             std::to_string(scene.frames),
             std::to_string(seen.touching_frames),
             std::to_string(seen.contacts),
             number_text(100 * rank_of(seen.depths, 0.99)),
             "1",
             number_text(100 * rank_of(seen.depths, 1)),
             is_cloth ? std::to_string(seen.crossed_frames) : "",
             is_cloth ? "0" : "",
             number_text(seen.trials),
             "1.5",
             number_text(seen.ms)};
    }
    row.resize(table.columns.size());
    table.rows.push_back(std::move(row));
  };
  add("coil", load_scene(scene_file("coil"), assets_folder(), {}), false);
  add("ears that fall on a back", scene_of_text(falling_ears(), "ears"), false);
  add("a folded sheet", scene_of_text(folded_sheet(), "sheet"), true);
  return table;
}

ReportTable self_question_table(const BenchSetting& setting) {
  ReportTable table{"touching-self-question", "Bodies that are asked whether they touch themselves, and do not"};
  table.note = fmt::format(
      "The first {} frames of scenes that ship. \"Unasked\" is the same scene with contact = {{ self = false }} in "
      "every body. Both are played {} times, in turn, and of each frame the quickest play counts.",
      asked_frames, plays);
  table.columns = {"scene",        "bodies",           "vertices",   "a frame [ms]",
                   "unasked [ms]", "over unasked [%]", "aim: below", "same states"};
  for (const char* const name : {"bunny", "squirrel", "materials", "rolling", "bunny-torus", "bars"}) {
    say_doing(setting, fmt::format("{}, asked and unasked", name));
    const AskedSeen seen = watch_asked(load_scene(scene_file(name), assets_folder(), {}), *setting.threads);
    std::vector<std::string> row = {name, "failed"};
    if (!seen.failed) {
      row = {name,
             std::to_string(seen.bodies),
             std::to_string(seen.vertices),
             number_text(seen.ms),
             number_text(seen.unasked_ms),
             number_text(100 * (seen.ms / seen.unasked_ms - 1)),
             "5",
             seen.same_bits ? "yes" : "no"};
    }
    row.resize(table.columns.size());
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace supple
