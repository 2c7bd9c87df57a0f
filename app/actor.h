// A body on its way through a film: its state, what it is driven by, and what is recorded of it.
#pragma once

#include "app/checkpoint.h"
#include "app/field_writer.h"
#include "base/threads.h"
#include "baselines/reference.h"
#include "output/point_cache.h"
#include "output/profile.h"
#include "output/run_folder.h"
#include "scene/assemble.h"
#include "scene/live.h"
#include "scene/obstacle.h"
#include "sim/model/model_values.h"
#include "sim/solver/search_rule.h"

namespace supple {

class Actor {
 public:
  // All that is passed must outlive the actor. kept_frames: of an earlier run's motion, which it goes on behind.
  Actor(const SceneDef& scene, Body& body, Model& model, const CollisionSet& set, const RunFolder& folder,
        Threads& threads, int kept_frames = 0);

  const Model& model() const { return model_; }
  const State& state() const { return state_; }

  // The scene and the body's definition have been changed; takes over what that means.
  void adopt(const ChangeCost& cost);

  // What a film goes on from.
  BodyMoment moment() const;
  void go_on_from(const BodyMoment& moment);

  // One frame's steps. Returns a message when the solver failed.
  std::string advance(int frame, bool measure_error, BodyRow& row);

  // Appends the frame to motion/.
  void save_motion();

  // The problem of a frame's first step, which has not been made yet, into the folder of states. Changes no result.
  void save_state(int frame);

  // The frame's fields into fields/.
  void save_fields(int frame);

 private:
  void set_inputs(int frame, int substep);
  void close_handles(double time);
  void update_model();
  void measure(int frame, BodyRow& row);

  const SceneDef& scene_;
  Body& body_;
  Model& model_;
  const CollisionSet& set_;
  const RunFolder& folder_;
  Triangles surface_;  // in the model's order; only with colliders
  State state_;
  Anchors anchors_;
  FrameInputs inputs_;
  std::unique_ptr<SearchRule> rule_;
  Workspace workspace_, reference_workspace_;
  std::optional<Reference> reference_;  // once an error is asked for
  std::optional<ModelValues> values_;   // once the model changes
  PointCacheWriter motion_;
  std::optional<FieldWriter> fields_;  // once fields are asked for
};

}  // namespace supple
