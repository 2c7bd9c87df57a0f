// A body and all that drives it through a scene: the targets of its handles, the colliders' motions, the solver's
// settings, and the handles that grab and let go. Films, stored states, benchmarks and estimates of cost all make
// their steps here, so that they agree to the last bit. Not here: what is recorded of a body (film/filmed_body.h).
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "scene/assemble.h"
#include "scene/live.h"
#include "scene/obstacle.h"
#include "sim/model/model_values.h"
#include "sim/solver/search_rule.h"

namespace supple {

// The solvers that scenes can name. Most of them live in a library that scenes do not know, so they come from outside.
struct Solvers {
  // A rule for the directions of one body's steps. It is made anew when the method or the model's values change.
  std::function<std::unique_ptr<SearchRule>(const SolverDef&, const Model&)> rule;
  // The settings that a step gets: the scene's, with what the method fixes whatever the scene says.
  std::function<SolverSettings(const SolverDef&)> settings;
};

class DrivenBody {
 public:
  // Puts the body where the scene has it start. `model` must have been built from the body; it and the description are
  // changed when a handle grabs or lets go. All that is passed by reference must outlive this object.
  DrivenBody(const SceneDef& scene, Body& body, Model& model, const CollisionSet& set, const Solvers& solvers,
             Threads* threads);

  const Body& body() const { return body_; }
  const Model& model() const { return model_; }
  const State& state() const { return state_; }
  const StepInputs& inputs() const { return inputs_; }  // of the step that was prepared last
  const CollisionSet& set() const { return set_; }
  Workspace& workspace() { return workspace_; }

  // Tells that the scene and the body's definition have changed, and makes anew what the change asks for.
  void apply(const ChangeCost& cost);

  // Puts the body into one of its states, earlier or later. The model's values are renewed where handles hold otherwise
  // than now; Model::id tells that they were.
  void restore(const State& state);

  // Makes the inputs of a step, and grabs and lets go where a handle's time has come. Doing it twice changes nothing.
  void prepare_step(int frame, int substep);
  // Makes the step that was prepared. The state changes only if it succeeds.
  const StepReport& step();

  // Makes all steps of a frame, and shows each report to `observe`. Returns the last one: it has failed, or all were
  // made.
  const StepReport& make_frame(int frame, const std::function<void(const StepReport&)>& observe);

 private:
  void switch_handles(double time);
  // Has the description's handles hold as the state says. False where they did already.
  bool hold_as_state_says();
  void renew_model();

  const SceneDef& scene_;
  Body& body_;
  Model& model_;
  const CollisionSet& set_;
  Solvers solvers_;
  State state_;
  StepInputs inputs_;
  std::unique_ptr<SearchRule> rule_;
  Workspace workspace_;
  std::optional<ModelValues> values_;  // once the model has changed
};

}  // namespace supple
