#include "film/record/filmed_body.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/frame_time.h"
#include "base/trace.h"
#include "film/record/state_file.h"
#include "output/files/obj_file.h"
#include "scene/building/body_surface.h"
#include "sim/contact/far_side.h"
#include "sim/model/measures.h"
#include "sim/solver/fields.h"

namespace supple {
namespace {

void add_up(BodyRow& row, const StepReport& report) {
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
  if (!row.contact) return;
  row.contact->collide_ms += report.collide_ms;
  row.contact->contacts = report.contacts.touching;
  row.contact->changes += report.contacts.changes;
  row.contact->cycles += report.contacts.cycles;
}

bool has_time_budget(const StepInputs& inputs) {
  return inputs.solver.budget_ms > 0 || inputs.repeated_cuts.has_value();
}

// Returns nothing for a step that had no budget in the earlier run.
std::optional<BudgetCuts> cuts_at(const CutsByFrame& cuts, int frame, int substep) {
  const std::vector<BudgetCuts>& of_frame = cuts.at(std::size_t(frame));
  if (substep >= std::ssize(of_frame)) return std::nullopt;
  return of_frame[std::size_t(substep)];
}

std::string failure_text(int frame, const std::string& body, const StepFailure& failure) {
  return fmt::format("frame {}: body '{}' failed while in '{}': {} (vertex {} is furthest out)", frame, body,
                     failure.during, failure.what, failure.vertex + 1);
}

}  // namespace

FilmedBody::FilmedBody(const SceneDef& scene, Body& body, Model& model, const CollisionSet& set,
                       const RunFolder& folder, const FilmSolvers& solvers, Threads& threads, int kept_frames)
    : scene_(scene),
      folder_(folder),
      solvers_(solvers),
      threads_(threads),
      driver_(scene, body, model, set, solvers.steps, &threads),
      motion_(folder.motion(body.def.name), model.vertices, kept_frames),
      origin_(motion_origin(body.description.mesh.rest)) {
  if (!set.colliders.empty()) forces_.emplace(folder.forces(body.def.name), model.vertices, kept_frames);
  start_energy_balance({});
  write_obj(folder.surface(body.def.name), body.description.mesh.rest, surface_of(body), origin_);
}

void FilmedBody::start_energy_balance(const EnergyBalance& balance) {
  driver_.workspace().prepare(model(), driver_.inputs().solver);
  energy_budget_.start(model(), scene_.gravity, state(), driver_.workspace(), balance);
}

void FilmedBody::resume(const State& state, const BodyRow& row) {
  driver_.restore(state);
  const BalanceRow before = row.balance.value_or(BalanceRow{});
  start_energy_balance({before.total, before.put_in, before.from_nothing, before.exchanged});
}

std::string FilmedBody::advance(int frame, bool measure_error, BodyRow& row) {
  row.name = driver_.body().def.name;
  if (!driver_.set().colliders.empty()) row.contact.emplace();
  for (int substep = 0; substep < scene_.substeps; ++substep) {
    driver_.prepare_step(frame, substep);
    if (repeated_ != nullptr) driver_.repeat(cuts_at(*repeated_, frame, substep));
    const bool measured = measure_error && substep + 1 == scene_.substeps;
    const State before = measured ? state() : State{};
    const StepReport& report = make_step();
    add_up(row, report);
    if (has_time_budget(driver_.inputs())) row.budget_cuts.push_back(report.cuts.after);
    if (report.failed) return failure_text(frame, row.name, report.failure);
    if (!measured) continue;
    row.error_measured = true;
    if (driver_.untangled()) continue;  // another energy has another minimum
    const MeasuredErrors errors = step_errors(before);
    row.error = errors.error;
    row.motion_error = errors.motion;
  }
  measure(frame, row);
  return "";
}

// Makes the step that was prepared, and follows its energy.
const StepReport& FilmedBody::make_step() {
  Workspace& w = driver_.workspace();
  {
    const Zone zone("energy budget", driver_.body().def.name);
    w.prepare(model(), driver_.inputs().solver);
    if (!energy_budget_.knows_springs()) energy_budget_.know_springs(model(), driver_.targets_at_start(), state());
    energy_budget_.before_step(model(), driver_.inputs(), state(), w);
    start_of_step_ = state().x;
  }
  const StepReport& report = driver_.step();
  if (report.failed) return report;
  const Zone zone("energy budget", driver_.body().def.name);
  if (driver_.untangled()) {
    energy_budget_.after_untangling(model(), driver_.inputs(), state(), w);
  } else {
    energy_budget_.after_step(model(), driver_.inputs(), start_of_step_, state(), w);
  }
  return report;
}

MeasuredErrors FilmedBody::step_errors(const State& before) {
  const Zone zone("reference error", driver_.body().def.name);
  if (metered_model_ != model().id) error_meter_ = solvers_.error_meter(model(), threads_);
  metered_model_ = model().id;
  return error_meter_->step_errors(model(), driver_.inputs(), before, state());
}

void FilmedBody::measure(int frame, BodyRow& row) {
  const Body& body = driver_.body();
  const Zone zone("measure", body.def.name);
  const Deformation shape = deformation(model(), state().x);
  row.stretch = shape.stretch;
  row.inverted = shape.inverted;
  row.collapsed = shape.collapsed;
  if (row.contact) {
    const std::vector<Collider>& colliders = driver_.set().colliders;
    const std::vector<double> depths =
        penetrations(colliders, driver_.inputs().collider_motions, state().x, model().surface);
    const std::vector<Vec3>& forces = driver_.workspace().report.collider_forces;
    for (std::size_t c = 0; c < colliders.size(); ++c) {
      const double far_side =
          reach_on_far_side(model(), colliders[c], driver_.inputs().collider_motions[c].end, state().x);
      row.contact->colliders.push_back({colliders[c].name, depths[c] / model().size, forces[c].norm(), far_side});
      row.contact->penetration = std::max(row.contact->penetration, depths[c] / model().size);
    }
  }
  const EnergyBalance& balance = energy_budget_.balance();
  row.balance = {balance.total, balance.put_in, balance.from_nothing, balance.exchanged};
  if (scene_.output.energy) {
    const Energies& energy = energy_budget_.energies();
    row.energy = {energy.kinetic, energy.elastic, energy.gravitational, energy.springs, energy.contact};
  }
  if (!body.motions.empty() && !body.def.handles.front().grabs) {
    const double time = frame_time(frame, scene_.fps);
    row.jiggle = jiggle(model(), state().x, body.motions.front().at(time));
  }
}

void FilmedBody::save_motion() {
  const Zone zone("motion files", driver_.body().def.name);
  const Positions written = as_cached(in_input_order(model(), state().x).rowwise() - origin_.transpose());
  motion_.add(written);
  saved_motion_ = written.rowwise() + origin_.transpose();
  if (!forces_) return;
  saved_forces_ = as_kept_forces(contact_forces(model(), driver_.workspace(), state().x));
  forces_->add(saved_forces_);
}

Positions FilmedBody::present_motion() const {
  const Positions points = in_input_order(model(), state().x).rowwise() - origin_.transpose();
  return as_cached(points).rowwise() + origin_.transpose();
}

void FilmedBody::save_problem(int frame) {
  const Zone zone("save state", driver_.body().def.name);
  driver_.prepare_step(frame, 0);
  write_state(folder_.state(driver_.body().def.name, frame),
              {scene_.name, scene_.title, frame, frame * scene_.substeps},
              problem_of(driver_.body().description, model(), driver_.inputs(), state()));
}

void FilmedBody::save_fields(int frame) {
  if (!fields_) fields_.emplace(driver_.body(), model(), folder_, scene_.fps);
  fields_->add(frame, state(), driver_.inputs(), driver_.workspace());
}

}  // namespace supple
