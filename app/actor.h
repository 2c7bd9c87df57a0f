// A body on its way through a film: its state, what it is driven by, and what is recorded of it.
#pragma once

#include "base/threads.h"
#include "baselines/reference.h"
#include "output/point_cache.h"
#include "output/profile.h"
#include "output/run_folder.h"
#include "scene/assemble.h"
#include "scene/obstacle.h"
#include "sim/search_rule.h"

namespace supple {

class Actor {
 public:
  // All that is passed must outlive the actor.
  Actor(const SceneDef& scene, const Body& body, const Model& model, const CollisionSet& set, const RunFolder& folder,
        Threads& threads);

  const Model& model() const { return model_; }
  const State& state() const { return state_; }

  // One frame's steps. Returns a message when the solver failed.
  std::string advance(int frame, bool measure_error, BodyRow& row);

  // Appends the frame to motion/.
  void save_motion();

  // The problem of a frame's first step, which has not been made yet, into the folder of states. Changes no result.
  void save_state(int frame);

 private:
  void set_inputs(int frame, int substep);
  void measure(int frame, BodyRow& row);

  const SceneDef& scene_;
  const Body& body_;
  const Model& model_;
  const CollisionSet& set_;
  const RunFolder& folder_;
  Triangles surface_;  // in the model's order; only with colliders
  State state_;
  FrameInputs inputs_;
  std::unique_ptr<SearchRule> rule_;
  Workspace workspace_, reference_workspace_;
  std::optional<Reference> reference_;  // once an error is asked for
  PointCacheWriter motion_;
};

}  // namespace supple
