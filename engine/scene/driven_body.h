// Represents a body and all that drives it through a scene: the targets of its handles, the colliders' motions, the
// solver's settings, and the handles that grab and release. Films, stored states, benchmarks and estimates of cost all
// make their steps here, so that they agree to the last bit. Not here: what is recorded of a body
// (film/record/filmed_body.h).
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "scene/building/assemble.h"
#include "scene/building/collision_set.h"
#include "scene/replay/live_keys.h"
#include "sim/model/model_values.h"
#include "sim/solver/search_rule.h"

namespace supple {

// Holds the solvers that scenes can name. Most of them are in a library that scenes do not depend on, so they are
// passed in.
struct Solvers {
  // Makes a rule for the directions of one body's steps. It is called again when the method or the model's values
  // change.
  std::function<std::unique_ptr<SearchRule>(const SolverDef&, const Model&)> rule;
  // Returns the settings of a step: the scene's, except for those that the method fixes.
  std::function<SolverSettings(const SolverDef&)> settings;
};

class DrivenBody {
 public:
  // Puts the body into the scene's start state. `model` must have been built from the body; it and the description
  // change when a handle grabs or releases. All that is passed by reference must outlive this object.
  DrivenBody(const SceneDef& scene, Body& body, Model& model, const CollisionSet& set, const Solvers& solvers,
             Threads* threads);

  const Body& body() const { return body_; }
  const Model& model() const { return model_; }
  const State& state() const { return state_; }
  const StepInputs& inputs() const { return inputs_; }  // of the step that was prepared last
  const CollisionSet& set() const { return set_; }
  Workspace& workspace() { return workspace_; }

  // Takes over a changed scene and body definition, and recomputes what the change requires.
  void apply(const ChangeCost& cost);

  // Puts the body into one of its states, earlier or later. The model's values are recomputed where handles hold in
  // another way than at present; Model::id shows that they were.
  void restore(const State& state);

  // Computes the inputs of a step, and lets handles grab and release when their time has come. A second call changes
  // nothing.
  void prepare_step(int frame, int substep);
  // Returns where the targets of handles are as the step that was prepared begins, in the order of Model::handled [m].
  Positions targets_at_start() const;
  // Makes the prepared step end where an earlier run's budget of time ended it, whatever budget this run has. Nothing:
  // the earlier run had none for this step.
  void repeat(const std::optional<BudgetCuts>& cuts);
  // Makes the prepared step. The state changes only if the step succeeds. With solver.untangle, and where
  // elements are inverted or without volume at its start, the step is made with the as-rigid-as-possible material
  // (materials/as_rigid_as_possible.h), which unfolds elements that the body's own material would keep folded. A, and
  // with it every direction, stays the same.
  const StepReport& step();
  bool untangled() const { return untangled_; }  // whether the last step was such a one

  // Makes all steps of a frame and passes each report to `observe`. Returns the last report: either that step failed,
  // or all steps were made.
  const StepReport& make_frame(int frame, const std::function<void(const StepReport&)>& observe);

 private:
  void switch_handles(double time);
  // Makes the description's handles hold as the state says. Returns false when they did so already.
  bool hold_as_state_says();
  void renew_model();
  const Model& rigid_model();

  const SceneDef& scene_;
  Body& body_;
  Model& model_;
  const CollisionSet& set_;
  Solvers solvers_;
  State state_;
  StepInputs inputs_;
  StepSpan span_{};  // of the step that was prepared last
  std::unique_ptr<SearchRule> rule_;
  Workspace workspace_;
  std::optional<ModelValues> values_;  // once the model has changed
  std::optional<Model> rigid_;         // as rigid as possible; once it was needed
  std::uint64_t rigid_for_ = 0;        // id of the model that it was made for
  bool untangled_ = false;
};

}  // namespace supple
