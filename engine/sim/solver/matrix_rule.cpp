#include "sim/solver/matrix_rule.h"

#include <algorithm>
#include <cmath>

#include "sim/contact/contact_direction.h"

namespace supple {
namespace {

// Departures up to this cost less than the renewal that would mend them. docs/method.md says how it was found.
constexpr double most_departure = 0.1;
constexpr TangentShares shares{};

// The Hessian's directions tell more than its departure how good it still is. It is poor where a step tried more than
// so many points an iteration, or came nearer by less than this factor in each: A does better then. Beyond the
// departure it is not even tried.
constexpr double most_trials = 1.25;
constexpr double least_progress = 0.25;
constexpr double most_departure_of_hessian = 0.5;
constexpr int longest_age = 1000000;

// Renewals of the Hessian may cost as much as this share of the evaluations of all steps, of ten iterations each.
constexpr double share_of_renewals = 0.1;
constexpr double evaluations_a_step = 11;

// Makes the matrix in force: the one that the state says, or a new one. False where there is none: then A serves.
bool make_tangent(const Model& model, const State& state, Workspace& w) {
  const bool known = state.matrix.rows() == model.vertices && w.tangent.make(model, state.matrix, shares, w.threads);
  if (known && w.tangent.departure(model, w.matrix_place) <= most_departure) return true;
  w.renewed = w.tangent.make(model, w.matrix_place, shares, w.threads);
  return w.renewed;
}

int least_age(const Model& model, const HessianSystem& hessian) {
  return static_cast<int>(std::ceil(hessian.renewal_cost(model) / (share_of_renewals * evaluations_a_step)));
}

// Likewise; A serves too where the Hessian is not good enough and too young to be renewed.
bool make_hessian(const Model& model, const State& state, Workspace& w) {
  if (state.matrix.rows() == model.vertices && w.hessian.make(model, state.matrix, w.threads)) {
    if (!state.matrix_poor && w.hessian.departure(model, w.matrix_place) <= most_departure_of_hessian) return true;
    if (state.matrix_age < least_age(model, w.hessian)) return false;
  }
  w.renewed = w.hessian.make(model, w.matrix_place, w.threads);
  return w.renewed;
}

bool has_tetrahedra(const Model& model) {
  return std::any_of(model.chunks.begin(), model.chunks.end(),
                     [](const Model::ChunkRange& c) { return c.kind == ElementKind::tetrahedron; });
}

}  // namespace

void prepare_matrix(const Model& model, const SolverSettings& solver, const State& state, Workspace& w) {
  if (state.matrix.rows() != model.vertices) return;
  if (solver.matrix == SystemMatrix::tangent) w.tangent.make(model, state.matrix, shares, w.threads);
  if (solver.matrix == SystemMatrix::hessian) w.hessian.make(model, state.matrix, w.threads);
}

void choose_matrix(const Model& model, const StepInputs& inputs, const State& state, Workspace& w) {
  w.renewed = false;
  // Implicit midpoint damps nothing: what ten iterations leave unsolved comes back, and velocities of a body that is
  // torn say little of where it is heading. Free bars of tests/sim/step_test.cpp flew apart with the tangent.
  if (inputs.solver.matrix != SystemMatrix::tangent || model.integrator != Integrator::backward_euler) return;
  const TimedPhase timed(w.clock, Phase::matrix, "matrix");
  w.matrix_place = state.x + model.time_step * state.v;
  if (!make_tangent(model, state, w)) return;
  w.system = w.correction.matrix = &w.tangent.system();
  if (has_colliders(inputs)) begin_corrections(model, w.correction);
}

// A body without tetrahedra has A: springs alone do not tell how far it has turned.
void choose_hessian(const Model& model, const StepInputs& inputs, const State& state, Workspace& w) {
  if (inputs.solver.matrix != SystemMatrix::hessian || model.integrator != Integrator::backward_euler) return;
  if (!w.current.contacts.empty() || !has_tetrahedra(model)) return;
  const TimedPhase timed(w.clock, Phase::matrix, "matrix");
  w.matrix_place = state.x + model.time_step * state.v;
  w.hessian_serves = make_hessian(model, state, w);
  if (w.hessian_serves) w.hessian.turn_to(w.current.x, w.threads);
}

namespace {

// Tells whether the step that was made had a hard time. `report` is the whole step's.
bool was_poor(const StepReport& report) {
  if (report.line_search > most_trials * report.iterations) return true;
  constexpr double round_off = 1e-12;
  return report.stop_reason == StopReason::iterations &&
         report.error_estimate > std::max(round_off, std::pow(least_progress, report.iterations));
}

}  // namespace

void remember_matrix(const Model& model, const SolverSettings& solver, const Workspace& w, State& state) {
  const bool of_hessian = solver.matrix == SystemMatrix::hessian;
  if (w.renewed) {
    state.matrix = w.matrix_place;
    state.matrix_age = 0;
  } else if (of_hessian) {
    state.matrix_age = std::min(state.matrix_age + 1, longest_age);
  } else if (w.system == static_cast<const System*>(&model)) {
    state.matrix.resize(0, 3);
    state.matrix_age = 0;
  }
  if (w.hessian_serves || !of_hessian) state.matrix_poor = of_hessian && was_poor(w.report);
}

}  // namespace supple
