#include "app/bench/subject.h"

#include <fmt/core.h>

#include <algorithm>
#include <fstream>

#include "app/state_file.h"
#include "app/verbs.h"
#include "base/error.h"
#include "base/hash.h"
#include "output/run_folder.h"
#include "baselines/make_rule.h"
#include "scene/scene_reader.h"

namespace supple {
namespace {

Body body_named(std::vector<Body> bodies, const SubjectChoice& choice) {
  for (Body& body : bodies) {
    if (body.def.name == choice.body) return std::move(body);
  }
  throw InputError(choice.scene, fmt::format("there is no body '{}'", choice.body));
}

// Names a state by all that it depends on: program, scene as resolved, body and frame.
std::string state_name(const Subject& subject, int frame) {
  std::uint64_t hash = program_identity();
  hash = hash_bytes(subject.resolved.data(), subject.resolved.size(), hash);
  hash = hash_bytes(subject.model.rest.data(), sizeof(double) * subject.model.rest.size(), hash);
  return fmt::format("{}-{}-{:08x}-{:06}", subject.scene.name, subject.body.def.name, static_cast<std::uint32_t>(hash),
                     frame);
}

}  // namespace

Subject::Subject(const SubjectChoice& chosen)
    : choice(chosen),
      scene(load_scene(scene_file(chosen.scene), assets_folder(), chosen.settings, &resolved)),
      body(body_named(assemble(scene), chosen)),
      model(build_model(body.description)),
      set(collision_set(scene)) {}

FrameInputs Subject::inputs(int frame) const {
  FrameInputs inputs{
      scene.gravity, {}, {}, settings_of(body.def.solver.method, body.def.solver.settings), &set.colliders};
  const double from = frame / scene.fps, to = from + scene.time_step();
  handle_targets(model, body, to, inputs.targets);
  if (model.scheme.theta < 1) handle_targets(model, body, 0.5 * (from + to), inputs.middle_targets);
  collider_motions(set, {from, to}, inputs.collider_motions);
  return inputs;
}

std::string Subject::size_text() const {
  return fmt::format("{} vertices, {} elements", model.vertices, model.elements);
}

std::vector<BenchState> states_of(const Subject& subject, const std::vector<int>& frames,
                                  const std::filesystem::path& folder, Threads& threads) {
  std::vector<BenchState> states;
  const auto stored = [&](int frame) { return folder / state_name(subject, frame); };
  const bool all_there = std::all_of(frames.begin(), frames.end(), [&](int frame) {
    std::error_code error;
    return std::filesystem::exists(stored(frame) / "state.json", error);
  });
  if (all_there) {
    for (const int frame : frames) {
      const StoredState read = read_state(stored(frame));
      states.push_back({frame, state_for(subject.model, read), 0});
      states.back().hash = state_hash(subject.model, states.back().before);
    }
    return states;
  }
  State state = start_state(subject.model, subject.body);
  const auto rule = make_rule(subject.body.def.solver.method, subject.model);
  Workspace workspace;
  workspace.threads = &threads;
  for (int frame = 0; frame <= frames.back(); ++frame) {
    const FrameInputs inputs = subject.inputs(frame);
    if (std::binary_search(frames.begin(), frames.end(), frame)) {
      states.push_back({frame, state, state_hash(subject.model, state)});
      write_state(stored(frame), {subject.scene.name, subject.scene.title, frame, frame * subject.scene.substeps},
                  problem_of(subject.body.description, subject.model, inputs, state));
    }
    for (int substep = 0; substep < subject.scene.substeps; ++substep) {
      FrameInputs own = inputs;
      if (substep > 0) {
        const double h = subject.scene.time_step(), from = frame / subject.scene.fps + substep * h;
        handle_targets(subject.model, subject.body, from + h, own.targets);
        collider_motions(subject.set, {from, from + h}, own.collider_motions);
      }
      const StepReport& report = step(subject.model, own, state, workspace, *rule);
      if (report.failed)
        throw RunError(fmt::format("{}, body '{}': frame {} failed: {}", subject.choice.scene, subject.choice.body,
                                   frame, report.failure.what));
    }
  }
  return states;
}

}  // namespace supple
