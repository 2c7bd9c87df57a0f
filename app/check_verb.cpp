#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include "app/film_run.h"
#include "app/solvers.h"
#include "app/verbs.h"
#include "base/console.h"
#include "base/error.h"
#include "base/text.h"
#include "film/earlier_run.h"
#include "film/pictures/picture_words.h"
#include "film/plan/film_coding.h"
#include "film/plan/loaded_film.h"
#include "film/plan/shipped_files.h"
#include "film/plan/slow_work_line.h"
#include "film/rough_pictures.h"
#include "output/files/json_text.h"
#include "scene/building/skin_report.h"
#include "scene/reading/sweep.h"
#include "scene/replay/script_trial.h"

namespace supple {
namespace {

using Json = nlohmann::ordered_json;

struct CheckCommand {
  std::string scene;
  std::vector<std::string> settings;
  bool no_cache = false, verbose = false, json = false;
};

// Holds all that a check looks at.
struct Checked {
  Script script;
  std::vector<Body> bodies;
  std::vector<DrawnBody> drawn;
  std::vector<std::string> missing;  // what is missing in the pictures of a rough first pass
};

Checked read_all(const CheckCommand& command) {
  const SceneSource source = opened_scene(command.scene, command.settings, command.json);
  std::vector<std::string> settings = command.settings;
  Checked checked{load_script(source, settings), {}, {}, {}};
  const SceneDef& scene = checked.script.scene();
  check_earlier_run(scene);
  if (scene.sweep_points > 0 && !checked.script.is_replay()) {
    check_sweep_points(source, assets_folder(), command.settings,
                       load_sweep(source, assets_folder(), command.settings));
  }
  {
    SlowWorkLine line(command.json);
    checked.bodies = assemble(scene, slow_work_with(!command.no_cache, line));
    checked.drawn = drawn_bodies(checked.bodies, slow_work_with(!command.no_cache, line));
  }
  try_changes(checked.script, checked.bodies);
  FilmPlan plan;
  plan.scene = source.path.string();
  plan.scene_text = source.text;
  plan.settings = std::move(settings);
  plan.cache = !command.no_cache;
  if (!scene.from) checked.missing = missing_in_rough_pictures(plan, all_solvers());
  return checked;
}

std::vector<std::string> notes_of(const Checked& checked) {
  std::vector<std::string> notes;
  for (const Body& body : checked.bodies)
    for (const std::string& note : body.notes) notes.push_back(fmt::format("{}: {}", body.source, note));
  for (const Body& body : checked.bodies) {
    const std::string advice = untangle_advice(body);
    if (!advice.empty()) notes.push_back(fmt::format("body '{}': {}", body.def.name, advice));
  }
  for (const ColliderDef& collider : checked.script.scene().colliders)
    for (const std::string& note : collider.shape.notes)
      notes.push_back(fmt::format("collider '{}': {}", collider.name, note));
  return notes;
}

// Lists what a scene asks its pictures to have, and a run of this program refuses to draw.
std::vector<Problem> undrawn(const SceneDef& scene) {
  std::vector<Problem> list = known_after_film(scene);
  try {
    check_passes(scene);
  } catch (const InputError& error) {
    list.insert(list.end(), error.problems().begin(), error.problems().end());
  }
  return list;
}

std::vector<Warning> listed_warnings(const Checked& checked) {
  std::vector<Warning> list = all_warnings(checked.script, checked.bodies);
  for (Problem& later : undrawn(checked.script.scene())) {
    later.message = "supple render refuses this: " + later.message;
    list.push_back({std::nullopt, std::move(later)});
  }
  if (auto letters = letters_warning(checked.script, text_font(checked.script.scene().text)))
    list.push_back({std::nullopt, std::move(*letters)});
  for (const std::string& one : checked.missing)
    list.push_back({std::nullopt, {{checked.bodies.front().def.place.source}, one}});
  for (std::size_t b = 0; b < checked.bodies.size(); ++b) {
    if (auto warning = skin_warning(checked.bodies[b], checked.drawn[b])) list.push_back(std::move(*warning));
  }
  return list;
}

void say_body(const Body& body, const DrawnBody& drawn, bool verbose) {
  const double crossing = crossing_number(body);
  const std::string skin = verbose ? skin_text(body, drawn) : skin_words(body, drawn);
  say(stdout,
      fmt::format("  {}: {} vertices, {} {}, {}{}\n", body.def.name, body.description.mesh.rest.rows(),
                  elements_of(body.description), body.description.springs.empty() ? "elements" : "springs",
                  stiffness_words(crossing), verbose ? fmt::format(" (k h^2 / (rho L^2) = {:.3g})", crossing) : ""));
  if (!skin.empty()) say(stdout, fmt::format("    skin: {}\n", skin));
}

void say_all(const Checked& checked, bool verbose) {
  const SceneDef& scene = checked.script.scene();
  for (const std::string& note : notes_of(checked)) say(stdout, fmt::format("note: {}\n", note));
  const std::vector<Warning> all = listed_warnings(checked);
  const std::vector<Problem> list = said(all);
  for (const Problem& warning : list) say(stdout, fmt::format("warning: {}\n", warning.text()));
  const std::size_t meant = all.size() - list.size();
  say(stdout, fmt::format("{}: no errors, {}{}; {}, {} {}\n", scene.name, count_text(long(list.size()), "warning"),
                          meant > 0 ? fmt::format(" ({} meant)", meant) : "", count_text(scene.frames, "frame"),
                          checked.bodies.size(), checked.bodies.size() == 1 ? "body" : "bodies"));
  for (std::size_t b = 0; b < checked.bodies.size(); ++b) say_body(checked.bodies[b], checked.drawn[b], verbose);
  if (checked.script.is_replay())
    say(stdout,
        fmt::format("  replay: {}, all possible\n", count_text(long(checked.script.changes().size()), "change")));
  if (scene.sweep_points > 0)
    say(stdout, fmt::format("  sweep: {}, all readable\n", count_text(long(scene.sweep_points), "point")));
}

Json json_of(const Checked& checked) {
  const SceneDef& scene = checked.script.scene();
  Json json = {{"scene", scene.name}, {"frames", scene.frames}};
  json["warnings"] = Json::array();
  for (const Warning& warning : listed_warnings(checked)) {
    const Json kind = warning.kind ? Json(name_of(*warning.kind)) : Json(nullptr);
    json["warnings"].push_back({{"kind", kind},
                                {"place", warning.problem.place.text()},
                                {"message", warning.problem.message},
                                {"meant", warning.meant}});
  }
  json["notes"] = notes_of(checked);
  json["bodies"] = Json::array();
  for (std::size_t b = 0; b < checked.bodies.size(); ++b) {
    const Body& body = checked.bodies[b];
    json["bodies"].push_back(
        {{"name", body.def.name},
         {"vertices", body.description.mesh.rest.rows()},
         {!body.description.springs.empty() ? "springs" : "elements", elements_of(body.description)},
         {"crossing_number", crossing_number(body)},
         {"skin", skin_text(body, checked.drawn[b])}});
  }
  return json;
}

int check(const CheckCommand& command) {
  const Checked checked = read_all(command);
  if (command.json) {
    say(stdout, json_text(json_of(checked)) + "\n");
  } else {
    say_all(checked, command.verbose);
  }
  return 0;
}

}  // namespace

void add_check(CommandLine& line) {
  auto command = std::make_shared<CheckCommand>();
  Verb verb = line.verb("check", "Every error and warning of a scene or replay at once; writes nothing but the cache.");
  verb.footer("Example: supple check my-scene.toml");
  verb.option("SCENE|REPLAY", command->scene,
              "scene or replay file, the name of one that ships, or - for standard input")
      .required();
  verb.option("--set", command->settings, "path=value over the scene's; may be repeated").repeatable();
  verb.flag("--no-cache", command->no_cache, "make meshes anew; keep none in the user's cache folder");
  verb.flag("--verbose", command->verbose,
            "also the numbers: how stiff a body is for its steps, how far its skin reaches");
  verb.flag("--json", command->json, "one line of JSON, which also has the warnings that the scene says are meant");
  verb.runs([command] { return check(*command); });
}

}  // namespace supple
