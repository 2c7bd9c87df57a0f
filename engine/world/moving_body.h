// Represents a body of a world, and all that drives it: the targets of its handles, the colliders' motions, the
// solver's settings, and the handles that grab and release. Only a World (world.h) makes its steps. Not here: what is
// recorded of a body (film/record/body_recorder.h).
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "scene/building/assemble.h"
#include "scene/building/collision_set.h"
#include "sim/model/inputs.h"
#include "sim/model/model.h"
#include "sim/model/report.h"
#include "sim/model/state.h"
#include "sim/solver/workspace.h"
#include "world/solvers.h"

namespace supple {

class ModelValues;
struct ChangeCost;
struct Contact;
struct SceneDef;

class MovingBody {
 public:
  // Puts the body into the scene's start state. `model` must have been built from the body. The model and the
  // description in the body change when a handle grabs or releases. All that is passed by reference must outlive this
  // object.
  MovingBody(const SceneDef& scene, Body& body, Model& model, const CollisionSet& set, const Solvers& solvers,
             Threads* threads);
  ~MovingBody();
  MovingBody(MovingBody&&) noexcept;

  const Body& body() const { return body_; }
  const Model& model() const { return model_; }
  const State& state() const { return state_; }
  const StepInputs& inputs() const { return inputs_; }  // of the step that was prepared last
  const CollisionSet& colliders() const { return set_; }
  // Gives the workspace of the body's steps, which is free for other use between two steps. It holds the last step's
  // report.
  OpenWorkspace& workspace() { return workspace_.open(); }
  const StepReport& report() const { return workspace_.report(); }  // of the last step

  // Returns the targets of handles at the beginning of the prepared step, in the order of Model::handled [m].
  Positions targets_at_start() const;
  // Returns how far the seams are open at the beginning of the prepared step; empty where there are none.
  std::vector<SeamOpening> seams_at_start() const;
  // Makes the prepared step end where an earlier run's budget of time ended it, whatever budget this run has. cuts:
  // nothing where the earlier run had no budget for this step.
  void repeat(const std::optional<BudgetCuts>& cuts);
  // Makes steps end by this run's own budget again.
  void keep_to_clock();
  // Tells whether the last step was made with the as-rigid-as-possible material.
  bool untangled() const { return untangled_; }
  // Tells whether the last step was that of a joined model (islands.h): together with other bodies, or with contact of
  // the body with itself.
  bool is_in_island() const { return is_in_island_; }

  // Puts the body into one of its states, earlier or later. The model's values are recomputed where other handles hold
  // than at present; Model::id then changes.
  void restore(const State& state);

 private:
  friend class World;
  friend class Islands;
  friend class Restitution;

  // Takes over a changed scene and body definition, and recomputes what the change requires.
  void apply(const ChangeCost& cost);
  // Sets the function that puts the targets of attached handles at a time [s] (attached_handles.h).
  void attach(std::function<void(double time, Positions& targets)> put) { put_attached_ = std::move(put); }

  // Computes the inputs of a step, lets handles grab and release when their time has come, and lets the body flow by
  // what its last step has left (flow_step.h). A second call changes nothing.
  void prepare_step(int frame, int substep);
  // Makes the prepared step. The state changes only if the step succeeds. With solver.untangle, and where elements are
  // inverted or without volume at its start, the step is made with the as-rigid-as-possible material
  // (materials/as_rigid_as_possible.h), which unfolds elements that the body's own material would keep folded. A
  // stays the same.
  const StepReport& step();

  // These two make the prepared step as that of a joined model (islands.h).
  //
  // Returns the model that is to be joined: the as-rigid-as-possible one where step() would take that.
  const Model& model_of_step();
  // Takes over the end of the step, unless the report says that it failed, and leaves the workspace as a step of the
  // body alone would. x, v: n x 3 in the order of the body's model [m], [m/s]; time: at the end [s]; contacts: those
  // that act on the body.
  void take_step(const Positions& x, Positions v, double time, std::vector<Contact> contacts, StepReport report);
  // Adds to the last step's time [ms].
  void add_time(double ms);

  const StepReport& step_untangled();
  void calm_down();
  // Computes the targets at a time [s]. change: the share that is done then of a change that is spread over the frame.
  void targets_at(double time, double change, Positions& targets) const;
  // Returns how far the seams are open at the end and in the middle of a step from one time to another [s]. The middle
  // has the mean of both ends: implicit midpoint then ends where seams are meant to be.
  std::vector<SeamOpening> seams_between(double from, double to) const;
  void switch_handles(double time);
  // Makes the description's handles hold as the state says. Returns false when they held so already.
  bool hold_as_state_says();
  void renew_model();
  const Model& rigid_model();

  // Takes the handle that was added to the body last into the model and the state. It does not hold yet.
  void add_handle();
  // Removes all handles but the first `count` from body, model and state.
  void keep_handles(std::size_t count);

  const SceneDef& scene_;
  Body& body_;
  Model& model_;
  const CollisionSet& set_;
  Solvers solvers_;
  State state_;
  StepInputs inputs_;
  StepSpan span_{};  // of the step that was prepared last
  std::unique_ptr<SearchRule> rule_;
  std::function<void(double time, Positions& targets)> put_attached_;  // empty: no handle is attached
  Workspace workspace_;
  std::unique_ptr<ModelValues> values_;  // made when the model first changes
  std::optional<Model> rigid_;           // the as-rigid-as-possible model; made when it is first needed
  std::uint64_t rigid_for_ = 0;          // id of the model that rigid_ was made for
  bool untangled_ = false, is_in_island_ = false;
  std::vector<double> lost_to_flow_;  // scratch
  double flow_ms_ = 0;                // of the flow before the step that was prepared
};

}  // namespace supple
