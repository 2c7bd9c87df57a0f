// Measures what the choices of docs/contact.md cost and gain, on the same states: it runs a scene with the defaults,
// and makes one step with each variant from each chosen state. It prints markdown. Usage: supple_contact_study ASSETS
// SCENE BODY EVERY FRAMES
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "baselines/reference.h"
#include "output/profile.h"
#include "scene/assemble.h"
#include "scene/obstacle.h"
#include "scene/scene_reader.h"
#include "sim/model/measures.h"
#include "sim/solver/step.h"

using namespace supple;

namespace {

struct Variant {
  std::string name;
  SolverSettings solver;
  std::vector<double> trials = {}, error = {}, depth = {}, ms = {};
  int failed = 0;
};

std::vector<Variant> variants(const SolverSettings& usual) {
  std::vector<Variant> list = {{"defaults", usual}};
  const auto add = [&](const std::string& name, const auto& change) {
    list.push_back({name, usual});
    change(list.back().solver);
  };
  add("history frozen", [](SolverSettings& s) { s.contact.history = ContactHistory::frozen; });
  add("history dropped", [](SolverSettings& s) { s.contact.history = ContactHistory::dropped; });
  add("no history (m = 0)", [](SolverSettings& s) { s.history = 0; });
  add("direction diagonal", [](SolverSettings& s) { s.contact.direction = ContactDirection::diagonal; });
  add("direction ignored", [](SolverSettings& s) { s.contact.direction = ContactDirection::ignored; });
  for (const double k : {10.0, 100.0, 1e3, 1e5})
    add(fmt::format("k_c {:g}", k), [k](SolverSettings& s) { s.contact.stiffness = k; });
  add("as the paper: ignored, frozen, k_c 100", [](SolverSettings& s) {
    s.contact.direction = ContactDirection::ignored;
    s.contact.history = ContactHistory::frozen;
    s.contact.stiffness = 100;
  });
  return list;
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 6) return 2;
  const SceneDef scene = load_scene(arguments[2], arguments[1], {});
  const std::vector<Body> bodies = assemble(scene);
  const Body& body =
      *std::find_if(bodies.begin(), bodies.end(), [&](const Body& b) { return b.def.name == arguments[3]; });
  const Model model = build_model(body.description);
  const CollisionSet set = collision_set(scene);
  Triangles surface = body.def.cloth ? body.cloth.surface.triangles : boundary_faces(body.description.mesh.tets);
  for (Eigen::Index i = 0; i < surface.size(); ++i) surface.data()[i] = model.internal_of[surface.data()[i]];
  StepInputs inputs{scene.gravity, {}, {}, body.def.solver.settings, &set.colliders};
  std::vector<Variant> list = variants(inputs.solver);
  State state = start_state(model, body);
  Threads threads(2);
  Workspace usual, trial, reference;
  for (Workspace* w : {&usual, &trial, &reference}) w->threads = &threads;
  Reference lowest(model);
  int states = 0;
  for (int frame = 0; frame < std::atoi(arguments[5]); ++frame) {
    const double h = scene.time_step();
    handle_targets(model, body, (frame + 1) * h, inputs.targets);
    collider_motions(set, {frame * h, (frame + 1) * h}, inputs.collider_motions);
    const State before = state;
    const StepReport& report = step(model, inputs, state, usual);
    if (report.failed) return 1;
    if (frame % std::atoi(arguments[4]) != 0 || report.contacts.touching == 0) continue;
    ++states;
    for (Variant& variant : list) {
      StepInputs varied = inputs;
      varied.solver = variant.solver;
      State after = before;
      const StepReport& varied_report = step(model, varied, after, trial);
      variant.failed += varied_report.failed || varied_report.stop_reason == StopReason::line_search_failed;
      variant.trials.push_back(varied_report.line_search);
      variant.ms.push_back(varied_report.step_ms);
      if (const auto error = lowest.step_error(model, varied, before, after, reference))
        variant.error.push_back(*error);
      variant.depth.push_back(penetration(set.colliders, inputs.collider_motions, after.x, surface) / model.size);
    }
  }
  fmt::print(
      "{}: {} states in contact\n\n| variant | trials | step ms, median | error, mean | error, p95 | "
      "penetration, p95 | searches failed |\n|---|---|---|---|---|---|---|\n",
      scene.name, states);
  for (const Variant& v : list) {
    const Distribution error = distribution_of(v.error);
    fmt::print("| {} | {:.1f} | {:.1f} | {:.1e} | {:.1e} | {:.1e} | {} |\n", v.name, distribution_of(v.trials).mean,
               distribution_of(v.ms).p50, error.mean, error.p95, distribution_of(v.depth).p95, v.failed);
  }
  return 0;
}
