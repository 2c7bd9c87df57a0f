#include "sim/solver/matrix_rule.h"

#include "sim/contact/contact_direction.h"

namespace supple {
namespace {

// Departures up to this cost less than the renewal that would mend them. docs/method.md says how it was found.
constexpr double most_departure = 0.1;
constexpr TangentShares shares{};

// Makes the matrix in force: the one that the state says, or a new one. False where there is none: then A serves.
bool make_matrix(const Model& model, const State& state, Workspace& w) {
  w.matrix_place = state.x + model.time_step * state.v;
  const bool known = state.matrix.rows() == model.vertices && w.tangent.make(model, state.matrix, shares, w.threads);
  if (known && w.tangent.departure(model, w.matrix_place) <= most_departure) return true;
  w.renewed = w.tangent.make(model, w.matrix_place, shares, w.threads);
  return w.renewed;
}

}  // namespace

void prepare_matrix(const Model& model, const State& state, Workspace& w) {
  if (state.matrix.rows() == model.vertices) w.tangent.make(model, state.matrix, shares, w.threads);
}

void choose_matrix(const Model& model, const StepInputs& inputs, const State& state, Workspace& w) {
  w.renewed = false;
  // Implicit midpoint damps nothing: what ten iterations leave unsolved comes back, and velocities of a body that is
  // torn say little of where it is heading. Free bars of tests/sim/step_test.cpp flew apart with the tangent.
  if (inputs.solver.matrix == SystemMatrix::constant || model.integrator != Integrator::backward_euler) return;
  const TimedPhase timed(w.clock, Phase::matrix, "matrix");
  if (!make_matrix(model, state, w)) return;
  w.system = w.correction.matrix = &w.tangent.system();
  if (has_colliders(inputs)) begin_corrections(model, w.correction);
}

void remember_matrix(const Model& model, const Workspace& w, State& state) {
  if (w.system == static_cast<const System*>(&model)) {
    state.matrix.resize(0, 3);
  } else if (w.renewed) {
    state.matrix = w.matrix_place;
  }
}

}  // namespace supple
