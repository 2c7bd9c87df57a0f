#include "film/filmed_body.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/trace.h"
#include "film/state_file.h"
#include "output/obj_file.h"
#include "sim/model/measures.h"
#include "sim/solver/energies.h"

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
  row.line_search += report.line_search;
  row.objective_start = report.objective.empty() ? 0 : report.objective.front();
  row.objective_end = report.objective.empty() ? 0 : report.objective.back();
  row.error_estimate = std::max(row.error_estimate, report.error_estimate);  // of the worst step of the frame
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

FilmedBody::FilmedBody(const SceneDef& scene, Body& body, Model& model, const CollisionSet& set,
                       const RunFolder& folder, const FilmSolvers& solvers, Threads& threads, int kept_frames)
    : scene_(scene),
      folder_(folder),
      solvers_(solvers),
      threads_(threads),
      driver_(scene, body, model, set, solvers.steps, &threads),
      motion_(folder.motion(body.def.name), model.vertices, kept_frames) {
  if (!set.colliders.empty()) surface_ = touching_surface(body, model);
  write_obj(folder.surface(body.def.name), body.description.mesh.rest, surface_of(body));
}

std::string FilmedBody::advance(int frame, bool measure_error, BodyRow& row) {
  row.name = driver_.body().def.name;
  if (!driver_.set().colliders.empty()) row.contact.emplace();
  for (int substep = 0; substep < scene_.substeps; ++substep) {
    driver_.prepare_step(frame, substep);
    const bool measured = measure_error && substep + 1 == scene_.substeps;
    const State before = measured ? state() : State{};
    const StepReport& report = driver_.step();
    add_up(row, report);
    if (report.failed) return failure_text(frame, row.name, report.failure);
    if (!measured) continue;
    row.error_measured = true;
    row.error = step_error(before);
  }
  measure(frame, row);
  return "";
}

std::optional<double> FilmedBody::step_error(const State& before) {
  const Zone zone("reference error", driver_.body().def.name);
  if (metered_model_ != model().id) error_meter_ = solvers_.error_meter(model(), threads_);
  metered_model_ = model().id;
  return error_meter_->step_error(model(), driver_.inputs(), before, state());
}

void FilmedBody::measure(int frame, BodyRow& row) {
  const Body& body = driver_.body();
  const Zone zone("measure", body.def.name);
  const Deformation shape = deformation(model(), state().x);
  row.stretch = shape.stretch;
  row.inverted = shape.inverted;
  if (row.contact) {
    row.contact->penetration =
        penetration(driver_.set().colliders, driver_.inputs().collider_motions, state().x, surface_) / model().size;
  }
  if (scene_.output.energy) {
    const Energies energy = energies(model(), state(), scene_.gravity, driver_.workspace());
    row.energy = {energy.kinetic, energy.elastic, energy.gravitational};
  }
  if (!body.motions.empty() && !body.def.handles.front().grabs) {
    const double time = (frame + 1) / scene_.fps;
    row.jiggle = jiggle(model(), state().x, body.motions.front().at(time));
  }
}

void FilmedBody::save_motion() {
  const Zone zone("motion files", driver_.body().def.name);
  motion_.add(in_input_order(model(), state().x));
}

void FilmedBody::save_state(int frame) {
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
