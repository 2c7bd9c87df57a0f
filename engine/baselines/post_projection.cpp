#include "baselines/post_projection.h"

#include "base/timing.h"

namespace supple {

const StepReport& step_then_project(const Model& model, const StepInputs& inputs, State& state, Workspace& w) {
  StepInputs without_colliders = inputs;
  without_colliders.solver.matrix = SystemMatrix::constant;  // as what it is compared with
  without_colliders.colliders = nullptr;
  const State before = state;
  const StepReport& report = step(model, without_colliders, state, w);
  if (report.failed || inputs.colliders == nullptr) return report;
  const Stopwatch watch;
  for (std::size_t c = 0; c < inputs.colliders->size(); ++c) {
    const Collider& collider = (*inputs.colliders)[c];
    const Eigen::Isometry3d& pose = inputs.collider_motions[c].end;
    for (int v = 0; v < model.free; ++v) {
      const SurfacePoint nearest = collider.shape.closest(pose.inverse() * Vec3(state.x.row(v)));
      if (nearest.distance >= collider.thickness) continue;
      state.x.row(v) = (pose * (nearest.point + collider.thickness * nearest.normal)).transpose();
    }
  }
  state.v.topRows(model.free) = (state.x - before.x).topRows(model.free) / model.time_step;
  w.report.collide_ms += watch.elapsed_ms();
  w.report.step_ms += watch.elapsed_ms();
  return report;
}

}  // namespace supple
