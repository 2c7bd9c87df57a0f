#include "app/actor.h"

#include <fmt/core.h>

#include "app/state_file.h"
#include "base/trace.h"
#include "baselines/make_rule.h"
#include "baselines/reference.h"
#include "output/obj_file.h"
#include "sim/model/measures.h"
#include "sim/solver/energies.h"
#include "sim/solver/step.h"

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
  row.stop_reason = name_of(report.stop_reason);
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

// In the numbering of the input file.
Triangles surface_of(const Body& body) {
  return body.def.cloth ? body.cloth.surface.triangles : boundary_faces(body.description.mesh.tets);
}

// The surface that may touch, in the model's numbering.
Triangles touching_surface(const Body& body, const Model& model) {
  Triangles surface = surface_of(body);
  for (Eigen::Index i = 0; i < surface.size(); ++i) surface.data()[i] = model.internal_of[surface.data()[i]];
  return surface;
}

}  // namespace

Actor::Actor(const SceneDef& scene, Body& body, Model& model, const CollisionSet& set, const RunFolder& folder,
             Threads& threads, int kept_frames)
    : scene_(scene),
      body_(body),
      model_(model),
      set_(set),
      folder_(folder),
      state_(start_state(model, body)),
      anchors_(rest_anchors(model, body)),
      motion_(folder.motion(body.def.name), model.vertices, kept_frames) {
  adopt({.rule = true});
  inputs_.colliders = &set.colliders;
  if (!set.colliders.empty()) surface_ = touching_surface(body, model);
  write_obj(folder.surface(body.def.name), body.description.mesh.rest, surface_of(body));
  workspace_.threads = &threads;
  reference_workspace_.threads = &threads;
}

void Actor::adopt(const ChangeCost& cost) {
  inputs_.gravity = scene_.gravity;
  inputs_.solver = settings_of(body_.def.solver.method, body_.def.solver.settings);
  if (cost.factor) update_model();
  if (cost.rule || cost.factor) rule_ = make_rule(body_.def.solver.method, model_);
}

void Actor::update_model() {
  if (!values_) values_.emplace(model_, body_.description);
  values_->set(model_, body_.description);
  reference_.reset();
}

// Handles that grab close and let go.
void Actor::close_handles(double time) {
  bool changed = false;
  for (std::size_t h = 0; h < body_.def.handles.size(); ++h) {
    const HandleDef& def = body_.def.handles[h];
    Handle& handle = body_.description.handles[h];
    if (!def.grabs) continue;
    if (time <= 0 && handle.holds) grab(model_, static_cast<int>(h), state_.x, anchors_);
    if (handle.holds == def.holds_at(time)) continue;
    handle.holds = !handle.holds;
    if (handle.holds) grab(model_, static_cast<int>(h), state_.x, anchors_);
    changed = true;
  }
  if (changed) adopt({.factor = true});
}

BodyMoment Actor::moment() const {
  BodyMoment moment{state_, anchors_, {}};
  for (const Handle& handle : body_.description.handles) moment.holds.push_back(handle.holds);
  return moment;
}

void Actor::go_on_from(const BodyMoment& moment) {
  state_ = moment.state;
  anchors_ = moment.anchors;
  bool changed = false;
  for (std::size_t h = 0; h < moment.holds.size(); ++h) {
    Handle& handle = body_.description.handles[h];
    changed |= handle.holds != (moment.holds[h] != 0);
    handle.holds = moment.holds[h] != 0;
  }
  if (changed) adopt({.factor = true});
}

void Actor::set_inputs(int frame, int substep) {
  const Zone zone("inputs", body_.def.name);
  const double done = static_cast<double>(frame) * scene_.substeps + substep, share = 1.0 / scene_.substeps;
  const StepSpan span{done * scene_.time_step(), (done + 1) * scene_.time_step(), substep * share,
                      (substep + 1) * share};
  close_handles(span.from);
  handle_targets(model_, body_, anchors_, span.to, span.change_to, inputs_.targets);
  if (model_.scheme.theta < 1)
    handle_targets(model_, body_, anchors_, 0.5 * (span.from + span.to), 0.5 * (span.change_from + span.change_to),
                   inputs_.middle_targets);
  collider_motions(set_, span, inputs_.collider_motions);
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
      const Zone zone("reference error", body_.def.name);
      row.error_measured = true;
      if (!reference_) reference_.emplace(model_);
      row.error = reference_->step_error(model_, inputs_, before, state_, reference_workspace_);
    }
  }
  measure(frame, row);
  return "";
}

void Actor::measure(int frame, BodyRow& row) {
  const Zone zone("measure", body_.def.name);
  const Deformation shape = deformation(model_, state_.x);
  row.stretch = shape.stretch;
  row.inverted = shape.inverted;
  if (row.contact)
    row.contact->penetration = penetration(set_.colliders, inputs_.collider_motions, state_.x, surface_) / model_.size;
  if (scene_.output.energy) {
    const Energies energy = energies(model_, state_, scene_.gravity, workspace_);
    row.energy = {energy.kinetic, energy.elastic, energy.gravitational};
  }
  if (!body_.motions.empty() && !body_.def.handles.front().grabs) {
    const double time = (frame + 1) / scene_.fps;
    row.jiggle = jiggle(model_, state_.x, body_.motions.front().at(time));
  }
}

void Actor::save_motion() {
  const Zone zone("motion files", body_.def.name);
  motion_.add(in_input_order(model_, state_.x));
}

void Actor::save_state(int frame) {
  const Zone zone("save state", body_.def.name);
  set_inputs(frame, 0);
  write_state(folder_.state(body_.def.name, frame), {scene_.name, scene_.title, frame, frame * scene_.substeps},
              problem_of(body_.description, model_, inputs_, state_));
}

void Actor::save_fields(int frame) {
  if (!fields_) fields_.emplace(body_, model_, folder_, scene_.fps);
  fields_->add(frame, state_, inputs_, workspace_);
}

}  // namespace supple
