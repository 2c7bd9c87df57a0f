// Runs a scene without pictures.
#pragma once

#include <gtest/gtest.h>

#include "scene/building/assemble.h"
#include "scene/building/collision_set.h"
#include "scene/definition/air_of_body.h"
#include "scene/reading/scene_reader.h"
#include "support/bodies.h"

namespace supple::test {

struct Film {
  SceneDef scene;
  std::vector<Body> bodies;
  std::vector<Model> models;
  CollisionSet set;

  Film(const std::filesystem::path& path, const std::vector<std::string>& settings)
      : scene(load_scene(path, test::assets, settings)), bodies(assemble(scene)), set(collision_set(scene)) {
    for (const Body& body : bodies) models.push_back(build_model(body.description));
  }

  // Calls visit(body, frame, state before, inputs, state after) after each step, with the workspace where it takes one.
  template <class Visit>
  void play(int thread_count, int frames, const Visit& visit) const {
    Threads threads(thread_count);
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      StepInputs inputs{scene.gravity, {}, {}, bodies[b].def.solver.settings, &set.colliders};
      inputs.wind = scene.wind.value_or(Wind{});
      if (const std::optional<PartAir> air = air_of(scene, bodies[b].def)) inputs.air = {*air};
      State state = start_state(models[b], bodies[b]);
      OpenWorkspace w;
      w.threads = &threads;
      for (int number = 0; number < frames * scene.substeps; ++number) {
        const double h = scene.time_step(), time = (number + 1) * h;
        handle_targets(models[b], bodies[b], time, inputs.targets);
        handle_targets(models[b], bodies[b], time - 0.5 * h, inputs.middle_targets);
        collider_motions(set, {time - h, time}, inputs.collider_motions);
        const State before = state;
        const StepReport& report = step(models[b], inputs, state, w);
        ASSERT_FALSE(report.failed) << bodies[b].def.name << " step " << number << ": " << report.failure.what;
        if constexpr (std::is_invocable_v<Visit, std::size_t, int, const State&, const StepInputs&, const State&,
                                          const OpenWorkspace&>) {
          visit(b, number, before, inputs, state, w);
        } else {
          visit(b, number, before, inputs, state);
        }
      }
    }
  }
};

}  // namespace supple::test
