#include "model_face.h"

#include <fmt/format.h>

#include <cmath>

#include "base/error.h"
#include "film/plan/shipped_files.h"
#include "geometry/files/mesh_file.h"
#include "scene/reading/table_readers.h"
#include "world_face.h"

namespace supple::python {
namespace {

Tetrahedra tetrahedra_of(const py::object& array) {
  const py::array given = py::array::ensure(array);
  if (!given) PyErr_Clear();
  if (!given || given.ndim() != 2 || given.shape(1) != 4 ||
      (given.dtype().kind() != 'i' && given.dtype().kind() != 'u'))
    throw InputError("tetrahedra", "is no array of m x 4 whole numbers");
  const auto numbers = py::array_t<std::int64_t, py::array::c_style | py::array::forcecast>::ensure(given);
  Tetrahedra result(numbers.shape(0), 4);
  for (Eigen::Index i = 0; i < result.size(); ++i) {
    const std::int64_t v = numbers.data()[i];
    if (v < 0 || v > INT32_MAX)
      throw InputError("tetrahedra", fmt::format("element {}: there is no vertex {}", i / 4, v));
    result.data()[i] = static_cast<std::int32_t>(v);
  }
  return result;
}

// Reads a dict as the table of a scene's file that a reader wants. Throws InputError with all problems.
template <class Read>
auto read_table(const py::dict& table, const char* name, const Read& read) {
  Config config = Config::parse(document_of(table), name, assets_folder());
  auto result = read(config.root());
  config.finish();
  return result;
}

void unsort_rows(const Model& model, const Positions& sorted, Positions& rows) {
  for (int v = 0; v < model.vertices; ++v) rows.row(v) = sorted.row(model.input_of[std::size_t(v)]);
}

void check_finite(const Positions& rows, const char* name) {
  for (Eigen::Index v = 0; v < rows.rows(); ++v) {
    if (!rows.row(v).allFinite()) throw InputError(name, fmt::format("row {} is not finite", v));
  }
}

}  // namespace

CollidersFace::CollidersFace(const py::list& tables) {
  SceneDef scene;
  py::dict document;
  document["collider"] = tables;
  scene.colliders = read_table(document, "colliders", [](const ConfigTable& root) {
    std::vector<ColliderDef> colliders;
    for (const ConfigTable& table : root.tables({"collider", "", "a rigid obstacle"}))
      colliders.push_back(read_collider(table));
    return colliders;
  });
  set = collision_set(scene);
}

ModelFace::ModelFace(const py::object& vertices, const py::object& tetrahedra, const py::object& material,
                     const py::object& density, double time_step, const py::object& pins,
                     const py::object& pin_stiffness, const py::dict& solver) {
  BodyDescription body;
  body.name = "model";
  body.mesh.rest = positions_of(vertices, "vertices");
  body.mesh.tets = tetrahedra_of(tetrahedra);
  body.mesh = checked_mesh(std::move(body.mesh), "tetrahedra", 0);
  body.mesh.regions.assign(std::size_t(body.mesh.tets.rows()), 0);
  py::dict owner;
  owner["material"] = material;
  const SubstanceDef substance = read_table(owner, "material", read_substance);
  const SolverDef solving =
      read_table(solver, "solver", [](const ConfigTable& root) { return read_solver(root, SolverDef{}); });
  if (solving.method != Method::quasi_newton) throw InputError("solver", "method: a model has the quasi-Newton method");
  body.materials = {substance.material};
  body.fibres = {substance.fibre};
  body.density = density.is_none() ? substance.usual_density.value_or(1000) : density.cast<double>();
  if (!(body.density > 0) || !std::isfinite(body.density)) throw InputError("density", "must be above 0 [kg/m^3]");
  if (!(time_step > 0) || !std::isfinite(time_step)) throw InputError("time_step", "must be above 0 [s]");
  body.time_step = time_step;
  body.fit = solving.fit;
  body.precision = solving.precision;
  body.integrator = solving.integrator;
  body.damping = solving.damping;
  settings = solving.settings;
  rest = body.mesh.rest;
  if (!pins.is_none()) {
    Handle handle{"pinned", {}, pin_stiffness.is_none() ? 0 : pin_stiffness.cast<double>()};
    if (!pin_stiffness.is_none() && !(handle.stiffness > 0 && std::isfinite(handle.stiffness)))
      throw InputError("pin_stiffness", "must be above 0 [N/m], or None");
    handle.vertices = vertices_of(pins, "pinned", rest.rows());
    std::vector<char> taken(std::size_t(rest.rows()), 0);
    for (const std::int32_t v : handle.vertices) {
      if (std::exchange(taken[std::size_t(v)], 1) != 0) throw InputError("pinned", fmt::format("vertex {} twice", v));
    }
    pinned = handle.vertices;
    if (!handle.vertices.empty()) body.handles = {handle};
  }
  const py::gil_scoped_release others_run;
  model = build_model(body);
}

StateFace::StateFace(std::shared_ptr<const ModelFace> model, int threads) : model_(std::move(model)) {
  if (threads < 1 || threads > 256) throw InputError("threads", "must be 1 to 256");
  held_ = std::make_unique<Held>(threads);
  held_->state = rest_state(model_->model);
  x_ = std::make_shared<Positions>(in_input_order(model_->model, held_->state.x));
  v_ = std::make_shared<Positions>(in_input_order(model_->model, held_->state.v));
}

StateFace::~StateFace() {
  if (getpid() != process_) (void)held_.release();  // its threads are in the process that made it
}

py::dict StateFace::step(const ModelFace& model, const py::object& gravity, const CollidersFace* colliders,
                         const py::object& targets) {
  const Busy::Use use(busy_);
  if (&model != model_.get()) throw InputError("state", "is of another model");
  StepInputs inputs;
  inputs.gravity = vector_of(gravity, "gravity");
  inputs.solver = model.settings;
  const Positions at = targets.is_none() ? Positions(model.rest(model.pinned, Eigen::all))
                                         : positions_of(targets, "targets", Eigen::Index(model.pinned.size()));
  inputs.targets = at;
  State& state = held_->state;
  if (model.model.scheme.theta < 1) {  // the middle of a straight way
    inputs.middle_targets = at;
    for (std::size_t i = 0; i < model.pinned.size(); ++i)
      inputs.middle_targets.row(Eigen::Index(i)) = 0.5 * (at.row(Eigen::Index(i)) + x_->row(model.pinned[i]));
  }
  if (colliders != nullptr) {
    inputs.colliders = &colliders->set.colliders;
    collider_motions(colliders->set, {state.time, state.time + model.model.time_step}, inputs.collider_motions);
  }
  check_finite(*x_, "positions");
  check_finite(*v_, "velocities");
  unsort_rows(model.model, *x_, state.x);
  unsort_rows(model.model, *v_, state.v);
  {
    const py::gil_scoped_release others_run;
    supple::step(model.model, inputs, state, held_->workspace);
  }
  const StepReport& report = held_->workspace.report();
  if (report.failed)
    throw StepFailed(fmt::format("the step failed while in '{}': {} (vertex {} is furthest out)", report.failure.during,
                                 report.failure.what, report.failure.vertex));
  sort_rows(model.model, state.x, *x_);
  sort_rows(model.model, state.v, *v_);
  py::dict result;
  result["step_ms"] = report.step_ms;
  result["iterations"] = report.iterations;
  result["line_search"] = report.line_search;
  result["decrease"] = report.decrease;
  result["error_estimate"] = report.error_estimate;
  result["motion_estimate"] = report.motion_estimate;
  result["unsolved"] = is_unsolved(report);
  result["stop_reason"] = std::string(name_of(report.stop_reason));
  result["contacts"] = report.contacts.touching;
  return result;
}

}  // namespace supple::python
