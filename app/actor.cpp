#include "app/actor.h"

#include <fmt/format.h>

#include "app/state_file.h"
#include "baselines/make_rule.h"
#include "baselines/reference.h"
#include "sim/measures.h"
#include "sim/step.h"

namespace supple {
namespace {

void add_up(BodyRow& row, const StepReport& report) {
  row.step_ms += report.step_ms;
  row.evaluate_ms += report.evaluate_ms;
  row.solve_ms += report.solve_ms;
  row.lbfgs_ms += report.lbfgs_ms;
  row.other_ms += report.other_ms;
  row.iterations += report.iterations;
  row.line_search += report.line_search;
  row.objective_start = report.objective.empty() ? 0 : report.objective.front();
  row.objective_end = report.objective.empty() ? 0 : report.objective.back();
  row.error_estimate = report.error_estimate;
  row.stop_reason = text_of(report.stop_reason);
  if (!row.contact) return;
  row.contact->collide_ms += report.collide_ms;
  row.contact->contacts = report.contacts.touching;
  row.contact->changes += report.contacts.changes;
  row.contact->cycles += report.contacts.cycles;
}

std::string failure_text(int frame, const std::string& body, const StepFailure& failure) {
  return fmt::format("frame {}: body '{}' failed while in '{}': {} (vertex {} is furthest out)", frame, body,
                     failure.phase, failure.what, failure.vertex + 1);
}

// The surface that may touch, in the model's numbering.
Triangles touching_surface(const Body& body, const Model& model) {
  Triangles surface = body.def.cloth ? body.surface : boundary_faces(body.description.mesh.tets);
  for (Eigen::Index i = 0; i < surface.size(); ++i) surface.data()[i] = model.internal_of[surface.data()[i]];
  return surface;
}

}  // namespace

Actor::Actor(const SceneDef& scene, const Body& body, const Model& model, const CollisionSet& set,
             const RunFolder& folder, Threads& threads)
    : scene_(scene),
      body_(body),
      model_(model),
      set_(set),
      folder_(folder),
      state_(start_state(model, body)),
      motion_(folder.motion(body.def.name), model.vertices) {
  inputs_.gravity = scene.gravity;
  inputs_.solver = settings_of(body.def.solver.method, body.def.solver.settings);
  rule_ = make_rule(body.def.solver.method, model);
  inputs_.colliders = &set.colliders;
  if (!set.colliders.empty()) surface_ = touching_surface(body, model);
  workspace_.threads = &threads;
  reference_workspace_.threads = &threads;
}

void Actor::set_inputs(int frame, int substep) {
  const double done = static_cast<double>(frame) * scene_.substeps + substep;
  const double from = done * scene_.time_step(), to = (done + 1) * scene_.time_step();
  handle_targets(model_, body_, to, inputs_.targets);
  if (model_.scheme.theta < 1) handle_targets(model_, body_, 0.5 * (from + to), inputs_.middle_targets);
  collider_motions(set_.obstacles, from, to, inputs_.collider_motions);
}

std::string Actor::advance(int frame, bool measure_error, BodyRow& row) {
  row.name = body_.def.name;
  if (!set_.colliders.empty()) row.contact.emplace();
  for (int substep = 0; substep < scene_.substeps; ++substep) {
    set_inputs(frame, substep);
    const bool measured = measure_error && substep + 1 == scene_.substeps;
    const State before = measured ? state_ : State{};
    const StepReport& report = step(model_, inputs_, state_, workspace_, *rule_);
    add_up(row, report);
    if (report.failed) return failure_text(frame, body_.def.name, report.failure);
    if (measured) {
      row.error_measured = true;
      if (!reference_) reference_.emplace(model_);
      row.error = reference_->step_error(model_, inputs_, before, state_, reference_workspace_);
    }
  }
  measure(frame, row);
  return "";
}

void Actor::measure(int frame, BodyRow& row) {
  const Deformation shape = deformation(model_, state_.x);
  row.stretch = shape.stretch;
  row.inverted = shape.inverted;
  if (row.contact)
    row.contact->penetration = penetration(set_.colliders, inputs_.collider_motions, state_.x, surface_) / model_.size;
  if (scene_.output.energy) {
    const Energies energy = energies(model_, state_, scene_.gravity, workspace_);
    row.energy = {energy.kinetic, energy.elastic, energy.gravitational};
  }
  if (!body_.motions.empty()) {
    const double time = (frame + 1) / scene_.fps;
    row.jiggle = jiggle(model_, state_.x, body_.motions.front().at(time));
  }
}

void Actor::save_motion() { motion_.add(in_input_order(model_, state_.x)); }

void Actor::save_state(int frame) {
  set_inputs(frame, 0);
  write_state(folder_.state(body_.def.name, frame), {scene_.name, scene_.title, frame, frame * scene_.substeps},
              problem_of(body_.description, model_, inputs_, state_));
}

}  // namespace supple
