#include "app/bench/subject.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.h"
#include "base/hash.h"
#include "baselines/make_rule.h"
#include "film/plan/shipped_files.h"
#include "film/record/checkpoint.h"
#include "film/record/state_file.h"
#include "output/files/whole_file.h"
#include "output/run/run_folder.h"
#include "scene/reading/scene_reader.h"

namespace supple {
namespace {

// Returns a world of one body of a scene. It does not touch itself: such a step is one for quasi-Newton directions, and
// with the rule of another method (solver_instead()) the body would stand still in it.
World world_of(SceneDef scene, const SubjectChoice& choice) {
  for (Body& body : assemble(scene)) {
    if (body.def.name != choice.body) continue;
    std::erase_if(scene.bodies, [&choice](const BodyDef& def) { return def.name != choice.body; });
    scene.bodies.front().contact.self = body.def.contact.self = false;
    std::vector<Body> alone;
    alone.push_back(std::move(body));
    return {std::move(scene), std::move(alone)};
  }
  throw InputError(choice.scene, fmt::format("there is no body '{}'", choice.body));
}

// Forms the name of a state from all that it depends on: the program, the resolved scene, the body and the frame.
std::string state_name(const Subject& subject, int frame) {
  std::uint64_t hash = program_identity();
  hash = hash_bytes(subject.resolved.data(), subject.resolved.size(), hash);
  hash = hash_bytes(subject.model().rest.data(), sizeof(double) * subject.model().rest.size(), hash);
  return fmt::format("{}-{}-{:08x}-{:06}", subject.scene().name, subject.body().def.name,
                     static_cast<std::uint32_t>(hash), frame);
}

// The name of a state covers all that it depends on, so its file needs no further identity.
constexpr const char* snapshot_identity = "{}";
constexpr const char* snapshot_file = "snapshot";

void write_snapshot(const Subject& subject, const BenchState& state, const StepInputs& inputs,
                    const std::filesystem::path& folder) {
  write_state(folder,
              {subject.scene().name, subject.scene().title, state.frame, state.frame * subject.scene().substeps},
              problem_of(subject.body().description, subject.model(), inputs, state.before));
  write_whole_file(folder / snapshot_file, checkpoint_bytes({state.frame, {state.before}}, snapshot_identity));
}

BenchState read_snapshot(const Subject& subject, int frame, const std::filesystem::path& folder) {
  const WorldState read = read_checkpoint(folder / snapshot_file, snapshot_identity);
  return {frame, read.bodies.front(), state_hash(subject.model(), read.bodies.front())};
}

}  // namespace

SceneDef scene_of_text(const std::string& text, const std::string& name, const std::vector<std::string>& settings) {
  Config config = Config::parse(text, name, assets_folder());
  for (const std::string& setting : settings) config.set(setting, exclusive_keys());
  SceneDef scene = read_scene(config);
  config.finish();
  return scene;
}

Solvers scenes_own_solver() { return {make_rule, settings_of}; }

std::string text_of(const DirectionStart& start) {
  return std::string(name_of(start.matrix)) + (start.second_level ? ", two levels" : "");
}

Solvers solver_instead(Method method, int iterations, DirectionStart start) {
  return {[method](const Method&, const Model& model) { return make_rule(method, model); },
          [method, iterations, start](const Method&, SolverSettings settings) {
            settings.iterations = iterations;
            settings.still = 0;
            settings.matrix = start.matrix;
            settings.levels = start.levels();
            return settings_of(method, settings);
          }};
}

Subject::Subject(const SubjectChoice& chosen)
    : choice(chosen),
      world(world_of(load_scene(scene_file(chosen.scene), assets_folder(), chosen.settings, &resolved), chosen)) {
  world.start(scenes_own_solver(), nullptr);
}

World Subject::new_world(const Solvers& solvers, Threads& threads) const {
  World other(scene(), world.bodies());
  other.start(solvers, &threads);
  return other;
}

const StepInputs& Subject::inputs(const BenchState& state) {
  world.body(0).restore(state.before);
  world.enter(state.frame);
  world.prepare(0);
  return world.body(0).inputs();
}

std::string Subject::size_text() const {
  return fmt::format("{} vertices, {} elements", model().vertices, model().elements);
}

std::vector<BenchState> states_of(Subject& subject, const std::vector<int>& frames, const std::filesystem::path& folder,
                                  Threads& threads) {
  std::vector<BenchState> states;
  const auto stored = [&](int frame) { return folder / state_name(subject, frame); };
  const bool all_there = std::all_of(frames.begin(), frames.end(), [&](int frame) {
    std::error_code error;
    return std::filesystem::exists(stored(frame) / snapshot_file, error);
  });
  if (all_there) {
    for (const int frame : frames) states.push_back(read_snapshot(subject, frame, stored(frame)));
    return states;
  }
  World world = subject.new_world(scenes_own_solver(), threads);
  const MovingBody& body = world.body(0);
  for (int frame = 0; frame <= frames.back(); ++frame) {
    world.enter(frame);
    if (std::binary_search(frames.begin(), frames.end(), frame)) {
      world.prepare(0);
      states.push_back({frame, body.state(), state_hash(body.model(), body.state())});
      write_snapshot(subject, states.back(), body.inputs(), stored(frame));
    }
    if (frame == frames.back()) break;
    if (!world.step())
      throw RunError(fmt::format("{}, body '{}': frame {} failed: {}", subject.choice.scene, subject.choice.body, frame,
                                 body.report().failure.what));
  }
  return states;
}

}  // namespace supple
