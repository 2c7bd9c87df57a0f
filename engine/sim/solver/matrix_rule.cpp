#include "sim/solver/matrix_rule.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "sim/contact/contact_direction.h"
#include "sim/elements/element.h"

namespace supple {
namespace {

// Departures up to this cost less than the renewal that would mend them: docs/lab/2026-11-24-matrices.md.
constexpr double most_departure = 0.1;
constexpr TangentShares shares{};

// The progress of the turned Hessian's directions tells better than the Hessian's departure how good it still is.
// Progress is the factor to which one evaluation reduces the error, so that less is better. The Hessian is poor where
// its progress is above that of A, or its departure above most_departure_of_hessian; it is worn where its progress is
// above worn_progress.
constexpr double worn_progress = 0.1;
constexpr double usual_progress = 0.25;  // progress of A, where A has not served lately
constexpr double forgetting = 0.1;       // share of A's progress that is forgotten in each step that A does not serve
constexpr double least_error = 1e-12;
constexpr double most_departure_of_hessian = 0.2;
constexpr int longest_age = 1000000;

// Renewals of the turned Hessian may cost as much as this share of the evaluations of all steps, of ten iterations
// each.
constexpr double share_of_renewals = 0.2;
constexpr double evaluations_a_step = 11;

// Makes the tangent matrix: the one that the state names, or a new one. Returns false where there is none; A then
// serves.
bool make_tangent(const Model& model, const SolverMemory& memory, OpenWorkspace& w) {
  const bool known =
      memory.matrix_made_at.rows() == model.vertices && w.tangent.make(model, memory.matrix_made_at, shares, w.threads);
  if (known && w.tangent.departure(model, w.next_matrix_at) <= most_departure) return true;
  w.renewed = w.tangent.make(model, w.next_matrix_at, shares, w.threads);
  return w.renewed;
}

int least_age(const Model& model, const TurnedHessianSystem& hessian) {
  return static_cast<int>(std::ceil(hessian.renewal_cost(model) / (share_of_renewals * evaluations_a_step)));
}

// Makes the turned Hessian in the same way. Also returns false, so that A serves, where the Hessian is poor and too
// young to be renewed.
bool make_turned_hessian(const Model& model, const SolverMemory& memory, OpenWorkspace& w) {
  if (memory.matrix_made_at.rows() == model.vertices &&
      w.turned_hessian.make(model, memory.matrix_made_at, w.threads)) {
    const double others = memory.system_progress > 0 ? memory.system_progress : usual_progress;
    const bool poor = memory.turned_hessian_progress > others ||
                      w.turned_hessian.departure(model, w.next_matrix_at) > most_departure_of_hessian;
    const bool worn = poor || memory.turned_hessian_progress > worn_progress;
    if (!worn || memory.matrix_age < least_age(model, w.turned_hessian)) return !poor;
  }
  w.renewed = w.turned_hessian.make(model, w.next_matrix_at, w.threads);
  return w.renewed;
}

bool has_tetrahedra(const Model& model) {
  return std::any_of(model.chunks.begin(), model.chunks.end(),
                     [](const Model::ChunkRange& c) { return c.kind == ElementKind::tetrahedron; });
}

}  // namespace

void prepare_matrix(const Model& model, const SolverSettings& solver, const State& state, OpenWorkspace& w) {
  const SolverMemory& memory = state.memory;
  if (memory.matrix_made_at.rows() != model.vertices) return;
  if (solver.matrix == StartMatrix::tangent) w.tangent.make(model, memory.matrix_made_at, shares, w.threads);
  if (solver.matrix == StartMatrix::turned_hessian) w.turned_hessian.make(model, memory.matrix_made_at, w.threads);
}

void put_in_force(const Model& model, const StepInputs& inputs, const System& system, OpenWorkspace& w) {
  w.system = w.correction.matrix = &system;
  w.turned_hessian_serves = false;
  if (may_touch(inputs)) begin_corrections(model, w.correction);
}

void choose_matrix(const Model& model, const StepInputs& inputs, const State& state, OpenWorkspace& w) {
  SUPPLE_CHECK(is_of_quasi_newton(inputs.solver.matrix), ==, true);
  w.renewed = false;
  // Implicit midpoint damps nothing: an error that ten iterations leave comes back, and the velocities of a torn body
  // say little of where it is heading. Free bars of tests/sim/step_test.cpp flew apart with the tangent.
  if (inputs.solver.matrix != StartMatrix::tangent || model.integrator != Integrator::backward_euler) return;
  const TimedPhase timed(w.clock, Phase::matrix, "matrix");
  w.next_matrix_at = state.x + model.time_step * state.v;
  if (make_tangent(model, state.memory, w)) put_in_force(model, inputs, w.tangent.system(), w);
}

// A body without tetrahedra has A: springs alone do not tell how far it has turned.
void choose_turned_hessian(const Model& model, const StepInputs& inputs, const State& state, OpenWorkspace& w) {
  if (inputs.solver.matrix != StartMatrix::turned_hessian || model.integrator != Integrator::backward_euler) return;
  if (!w.current.contacts.empty() || !has_tetrahedra(model)) return;
  const TimedPhase timed(w.clock, Phase::matrix, "matrix");
  w.next_matrix_at = state.x + model.time_step * state.v;
  w.turned_hessian_serves = make_turned_hessian(model, state.memory, w);
  if (w.turned_hessian_serves) w.turned_hessian.turn_to(w.current.x, w.threads);
}

namespace {

// Returns the factor by which one evaluation reduced the error. report: the report of the whole step.
double progress_of(const StepReport& report) {
  if (report.newton_iterations > 0) return 1;
  const double left = std::clamp(report.error_estimate, least_error, 1.0);
  return std::pow(left, 1.0 / std::max(report.line_search, 1));
}

void remember_progress(const OpenWorkspace& w, SolverMemory& memory) {
  if (w.turned_hessian_serves) {
    memory.turned_hessian_progress = progress_of(w.report);
    if (memory.system_progress > 0) memory.system_progress += forgetting * (usual_progress - memory.system_progress);
  } else if (w.current.contacts.empty()) {
    memory.system_progress = progress_of(w.report);
  }
}

}  // namespace

void remember_matrix(const Model& model, const SolverSettings& solver, const OpenWorkspace& w, SolverMemory& memory) {
  const bool turned = solver.matrix == StartMatrix::turned_hessian;
  if (w.renewed) {
    memory.matrix_made_at = w.next_matrix_at;
    memory.matrix_age = 0;
  } else if (turned) {
    memory.matrix_age = std::min(memory.matrix_age + 1, longest_age);
  } else if (w.system == static_cast<const System*>(&model)) {
    memory.matrix_made_at.resize(0, 3);
    memory.matrix_age = 0;
  }
  if (turned) {
    remember_progress(w, memory);
  } else {
    memory.turned_hessian_progress = memory.system_progress = 0;
  }
}

}  // namespace supple
