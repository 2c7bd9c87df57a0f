#include <fmt/core.h>

#include "app/verbs.h"
#include "base/console.h"
#include "base/error.h"
#include "film/picture_words.h"
#include "film/places.h"
#include "film/progress.h"
#include "scene/script_trial.h"
#include "scene/skin_report.h"
#include "scene/sweep.h"
#include "scene/warnings.h"

namespace supple {
namespace {

int check(const std::string& name, const std::vector<std::string>& settings, bool cache) {
  const SceneSource source = scene_source(name);
  const Script script = Script::load(source, assets_folder(), settings);
  const SceneDef& scene = script.scene();
  if (scene.sweep_points > 0 && !script.is_replay()) {
    check_sweep_points(source, assets_folder(), settings, load_sweep(source, assets_folder(), settings));
  }
  std::vector<Body> bodies;
  std::vector<DrawnBody> drawn;
  {
    MakingLine line(false);
    bodies = assemble(scene, making_with(cache, line));
    drawn = drawn_bodies(bodies, making_with(cache, line));
  }
  try_changes(script, bodies);
  for (const Body& body : bodies) {
    for (const std::string& note : body.notes) say(stdout, fmt::format("note: {}: {}\n", body.source, note));
  }
  for (const Body& body : bodies) {
    const std::string advice = untangle_advice(body);
    if (!advice.empty()) say(stdout, fmt::format("note: body '{}': {}\n", body.def.name, advice));
  }
  for (const ColliderDef& collider : scene.colliders) {
    for (const std::string& note : collider.shape.notes)
      say(stdout, fmt::format("note: collider '{}': {}\n", collider.name, note));
  }
  std::vector<Problem> list = all_warnings(script, bodies);
  for (Problem& later : known_after_film(scene)) {
    later.message = "supple render refuses this: " + later.message;
    list.push_back(std::move(later));
  }
  if (auto letters = letters_warning(script, caption_font())) list.push_back(std::move(*letters));
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (auto warning = skin_warning(bodies[b], drawn[b])) list.push_back(std::move(*warning));
  }
  for (const Problem& warning : list) say(stdout, fmt::format("warning: {}\n", warning.text()));
  say(stdout,
      fmt::format("{}: no errors, {} warning{}; {} frames, {} {}\n", scene.name, list.size(),
                  list.size() == 1 ? "" : "s", scene.frames, bodies.size(), bodies.size() == 1 ? "body" : "bodies"));
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const Body& body = bodies[b];
    const TetMesh& mesh = body.description.mesh;
    say(stdout,
        fmt::format("  {}: {} vertices, {} {}, k h^2 / (rho L^2) = {:.3g} (stiff above 300)\n", body.def.name,
                    mesh.rest.rows(), body.def.cloth ? body.description.springs.size() : std::size_t(mesh.tets.rows()),
                    body.def.cloth ? "springs" : "elements", crossing_number(body)));
    const std::string skin = skin_text(body, drawn[b]);
    if (!skin.empty()) say(stdout, fmt::format("    skin: {}\n", skin));
  }
  if (script.is_replay())
    say(stdout, fmt::format("  replay: {} change{}, all possible\n", script.changes().size(),
                            script.changes().size() == 1 ? "" : "s"));
  if (scene.sweep_points > 0)
    say(stdout,
        fmt::format("  sweep: {} point{}, all readable\n", scene.sweep_points, scene.sweep_points == 1 ? "" : "s"));
  return 0;
}

}  // namespace

void add_check(CommandLine& line) {
  auto name = std::make_shared<std::string>();
  auto settings = std::make_shared<std::vector<std::string>>();
  auto no_cache = std::make_shared<bool>(false);
  Verb verb = line.verb("check", "Every error and warning of a scene or replay at once; writes nothing but the cache.");
  verb.footer("Example: supple check my-scene.toml");
  verb.option("SCENE|REPLAY", *name, "scene or replay file, the name of one that ships, or - for standard input")
      .required();
  verb.option("--set", *settings, "path=value over the scene's; may be repeated").repeatable();
  verb.flag("--no-cache", *no_cache, "make meshes anew; keep none in the user's cache folder");
  verb.runs([name, settings, no_cache] { return check(*name, *settings, !*no_cache); });
}

}  // namespace supple
