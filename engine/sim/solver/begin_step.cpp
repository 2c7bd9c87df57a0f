#include "sim/solver/begin_step.h"

#include "base/error.h"
#include "sim/contact/contact_direction.h"
#include "sim/solver/first_forces.h"
#include "sim/solver/matrix_rule.h"
#include "sim/solver/objective.h"

namespace supple {

void inertial_prediction(const Model& model, const StepInputs& inputs, const State& state, Positions& y) {
  const double h = model.time_step;
  y = (state.x + h * state.v).rowwise() + (model.scheme.force * h * h * inputs.gravity).transpose();
}

void begin_air(const Model& model, const StepInputs& inputs, const State& state, AirForces& air) {
  air.begin(model, inputs, state.x, state.time + model.scheme.theta * model.time_step);
}

void begin_seams(const Model& model, const StepInputs& inputs, OpenWorkspace& w) {
  if (model.seams.empty()) return;
  open_gaps(model, inputs.seams, model.scheme.theta < 1 ? &SeamOpening::middle : &SeamOpening::end, w.seam_gaps);
}

namespace {

// Puts held vertices at their targets in both iterates, and writes the targets to which soft handles pull.
void set_targets(const Model& model, const StepInputs& inputs, OpenWorkspace& w) {
  const bool midway = model.scheme.theta < 1;
  SUPPLE_CHECK(inputs.targets.rows(), ==, Eigen::Index(model.handled.size()));
  if (midway && !model.handle_stiffness.empty())
    SUPPLE_CHECK(inputs.middle_targets.rows(), ==, Eigen::Index(model.handled.size()));
  for (std::size_t i = 0; i < model.handled.size(); ++i) {
    const std::int32_t v = model.handled[i].vertex;
    if (!model.handled[i].holds) continue;
    if (v < model.free) {
      w.target.row(v) = midway ? inputs.middle_targets.row(i) : inputs.targets.row(i);
    } else {
      w.current.x.row(v) = inputs.targets.row(i);
    }
  }
  const int held = model.vertices - model.free;
  if (held > 0) w.trial.x.bottomRows(held) = w.current.x.bottomRows(held);
}

}  // namespace

void begin_step(const Model& model, const StepInputs& inputs, const State& state, OpenWorkspace& w) {
  SUPPLE_CHECK(state.x.rows(), ==, model.vertices);
  SUPPLE_CHECK(state.v.rows(), ==, model.vertices);
  inertial_prediction(model, inputs, state, w.y);
  begin_air(model, inputs, state, w.air);
  begin_seams(model, inputs, w);
  w.start_positions = &state.x;
  w.contact_energy_at_y.reset();
  w.correction.threads = w.threads;
  w.second_level_serves = false;
  w.correction.second = nullptr;
  w.is_bowed = false;
  if (needs_start(model)) w.start_copy = state.x;
  w.current.contacts.clear();
  w.trial.contacts.clear();
  if (may_touch(inputs)) {
    const TimedPhase timed(w.clock, Phase::collide, "begin contacts");
    begin_contacts(model, inputs, state.x, w.y, w.threads, w.contact);
  }
  put_in_force(model, inputs, model, w);
  if (may_touch(inputs)) begin_sticking(model, state.v, w.correction);
  if (has_colliders(inputs)) find_first_forces(model, inputs, state, w);
  w.current.x = w.y;
  set_targets(model, inputs, w);
}

}  // namespace supple
