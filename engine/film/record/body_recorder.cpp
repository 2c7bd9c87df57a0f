#include "film/record/body_recorder.h"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "base/trace.h"
#include "film/record/state_file.h"
#include "output/files/obj_file.h"
#include "scene/building/body.h"
#include "sim/contact/find_contacts.h"
#include "sim/measures/far_side.h"
#include "sim/measures/fields.h"
#include "sim/measures/measures.h"
#include "sim/solver/open_workspace.h"

namespace supple {

void add_up(StepRow& row, const StepReport& report) {
  row.step_ms += report.step_ms;
  row.evaluate_ms += report.evaluate_ms;
  row.solve_ms += report.solve_ms;
  row.lbfgs_ms += report.lbfgs_ms;
  row.matrix_ms += report.matrix_ms;
  row.other_ms += report.other_ms;
  row.iterations += report.iterations;
  row.newton_iterations += report.newton_iterations;
  row.line_search += report.line_search;
  row.objective_start = report.objective.empty() ? 0 : report.objective.front();
  row.objective_end = report.objective.empty() ? 0 : report.objective.back();
  row.error_estimate = std::max(row.error_estimate, report.error_estimate);  // of the worst step of the frame
  row.motion_estimate = std::max(row.motion_estimate, report.motion_estimate);
  row.unsolved = row.unsolved || is_unsolved(report);
  row.stop_reason = name_of(report.stop_reason);
}

namespace {

void add_up(ContactRow& row, const StepReport& report) {
  row.collide_ms += report.collide_ms;
  row.contacts = report.contacts.touching;
  row.changes += report.contacts.changes;
  row.cycles += report.contacts.cycles;
}

}  // namespace

std::string failure_text(int frame, const std::string& body, const StepFailure& failure) {
  return fmt::format("frame {}: body '{}' failed while in '{}': {} (vertex {} is furthest out)", frame, body,
                     failure.during, failure.what, failure.vertex + 1);
}

BodyRecorder::BodyRecorder(World& world, std::size_t body, const RunFolder* folder, WorldErrors& errors,
                           int kept_frames)
    : world_(world),
      body_(body),
      folder_(folder),
      errors_(errors),
      origin_(motion_origin(world.bodies()[body].description.mesh.rest)) {
  start_energy_balance({});
  if (folder == nullptr) return;
  const Body& recorded = world.bodies()[body];
  motion_.emplace(folder->motion(recorded.def.name), model().vertices, kept_frames);
  if (world.scene().may_touch()) forces_.emplace(folder->forces(recorded.def.name), model().vertices, kept_frames);
  write_obj(folder->surface(recorded.def.name), recorded.description.mesh.rest, surface_of(recorded), origin_);
}

void BodyRecorder::start_energy_balance(const EnergyBalance& balance) {
  OpenWorkspace& w = moving().workspace();
  w.prepare(model(), moving().inputs().solver);
  energy_budget_.start(model(), moving().inputs(), state(), w, balance);
}

void BodyRecorder::resume(const BodyRow& row) {
  const BalanceRow before = row.balance.value_or(BalanceRow{});
  start_energy_balance({before.total, before.put_in, before.from_nothing, before.held, before.worked});
}

void BodyRecorder::begin_frame(int frame, bool measure_error, BodyRow& row) {
  frame_ = frame;
  measures_error_ = measure_error;
  row_ = &row;
  row.name = body().def.name;
  if (!world_.colliders().colliders.empty()) row.contact.emplace();
}

void BodyRecorder::end_repeats() {
  if (std::exchange(repeated_, nullptr) != nullptr) moving().keep_to_clock();
}

void BodyRecorder::before_step(int substep) {
  const Zone zone("energy budget", body().def.name);
  if (repeated_ != nullptr && frame_ < std::ssize(*repeated_)) {
    moving().repeat(cuts_at(*repeated_, frame_, substep));
  } else {
    end_repeats();
  }
  if (is_measured(substep)) errors_.before_step(body_);
  OpenWorkspace& w = moving().workspace();
  w.prepare(model(), moving().inputs().solver);
  if (!energy_budget_.knows_springs())
    energy_budget_.know_springs(model(), moving().targets_at_start(), moving().seams_at_start(), state());
  energy_budget_.before_step(model(), moving().inputs(), state(), w);
  start_of_step_ = state().x;
}

void BodyRecorder::after_step(int substep) {
  const StepReport& report = moving().report();
  if (!report.failed) {
    const Zone zone("energy budget", body().def.name);
    if (moving().untangled()) {
      energy_budget_.after_untangling(model(), moving().inputs(), state(), moving().workspace());
    } else {
      energy_budget_.after_step(model(), moving().inputs(), start_of_step_, state(), moving().workspace());
    }
  }
  add_up(*row_, report);
  if (row_->contact) add_up(*row_->contact, report);
  if (has_time_budget(moving().inputs())) row_->budget_cuts.push_back(report.cuts.after);
  if (!report.failed && is_measured(substep)) measure_errors();
}

std::string BodyRecorder::failure() const {
  const StepReport& report = moving().report();
  return report.failed ? failure_text(frame_, body().def.name, report.failure) : "";
}

void BodyRecorder::measure_errors() {
  row_->error_measured = true;
  const std::optional<MeasuredErrors> errors = errors_.of_step(body_);
  if (!errors) return;
  row_->error = errors->error;
  row_->motion_error = errors->motion;
  row_->reference_converged = errors->converged;
}

void BodyRecorder::measure_contact() {
  const std::vector<Collider>& colliders = world_.colliders().colliders;
  const std::vector<ColliderMotion>& motions = moving().inputs().collider_motions;
  Positions touching = state().x;
  if (const Positions drawn = drawn_offsets(model(), touching, nullptr); drawn.rows() > 0) touching += drawn;
  const std::vector<double> depths = penetrations(colliders, motions, touching, model().surface);
  const std::vector<Vec3>& forces = moving().report().collider_forces;
  ContactRow& row = *row_->contact;
  for (std::size_t c = 0; c < colliders.size(); ++c) {
    const double far_side = reach_on_far_side(model(), colliders[c], motions[c].end, state().x);
    row.colliders.push_back({colliders[c].name, depths[c] / model().size, forces[c].norm(), far_side});
    row.penetration = std::max(row.penetration, depths[c] / model().size);
  }
}

void BodyRecorder::measure_seams() {
  Positions gaps;
  open_gaps(model(), moving().inputs().seams, &SeamOpening::end, gaps);
  row_->open_seam = widest_seam(model(), gaps, state().x) / mean_edge(model().surface, model().rest);
}

void BodyRecorder::end_frame() {
  const Zone zone("measure", body().def.name);
  const Deformation shape = deformation(model(), state().x, moving().workspace().threads);
  row_->stretch = shape.stretch;
  row_->inverted = shape.inverted;
  row_->collapsed = shape.collapsed;
  if (row_->contact) measure_contact();
  if (!model().seams.empty()) measure_seams();
  const EnergyBalance& balance = energy_budget_.balance();
  row_->balance = {balance.total, balance.put_in, balance.from_nothing, balance.held, balance.worked};
  if (model().flows()) row_->balance->flowed = balance.flowed;
  if (world_.scene().output.energy) {
    const Energies& energy = energy_budget_.energies();
    row_->energy = {energy.kinetic, energy.elastic, energy.gravitational, energy.springs, energy.contact};
  }
  if (!body().motions.empty() && !body().def.handles.front().grabs) {
    const double time = world_.scene().time_after(frame_);
    row_->jiggle = jiggle(model(), state().x, body().motions.front().at(time));
  }
}

void BodyRecorder::save_motion() {
  const Zone zone("motion files", body().def.name);
  const Positions written = cached_motion();
  if (motion_) motion_->add(written);
  saved_motion_ = written.rowwise() + origin_.transpose();
  note_forces();
  if (forces_) forces_->add(saved_forces_);
}

void BodyRecorder::note_motion() {
  saved_motion_ = present_motion();
  note_forces();
}

// Returns the present positions with the digits of the files, relative to their origin [m].
Positions BodyRecorder::cached_motion() const {
  return as_cached(in_input_order(model(), state().x).rowwise() - origin_.transpose());
}

// Notes the present forces, which the last step has left. There are none where no step led to the present state.
void BodyRecorder::note_forces() {
  if (!world_.scene().may_touch()) return;
  saved_forces_ = world_.has_stepped() ? as_kept_forces(contact_forces(model(), moving().workspace(), state().x))
                                       : Positions(Positions::Zero(model().vertices, 3));
}

Positions BodyRecorder::present_motion() const { return cached_motion().rowwise() + origin_.transpose(); }

void BodyRecorder::save_problem(int frame) {
  const Zone zone("save state", body().def.name);
  const SceneDef& scene = world_.scene();
  write_state(folder_->state(body().def.name, frame), {scene.name, scene.title, frame, frame * scene.substeps},
              problem_of(body().description, model(), moving().inputs(), state()));
}

void BodyRecorder::save_fields(int frame) {
  if (!fields_) fields_.emplace(body(), model(), *folder_, world_.scene());
  fields_->add(frame, state(), moving().workspace());
}

}  // namespace supple
