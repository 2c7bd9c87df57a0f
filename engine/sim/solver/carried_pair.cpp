#include "sim/solver/carried_pair.h"

#include <algorithm>
#include <cmath>

#include "base/hash.h"

namespace supple {
namespace {

// After so many misses in a row, the wait between two attempts grows no further.
constexpr int most_misses = 5;

// The corrections of a step with a larger estimate of its error are not those that it needed. At 0.01, bars whose free
// half is 1e4 times as stiff gained up to their own energy from nothing; at 1e-3, none does.
constexpr double most_error = 1e-3;

// Tells by its numbers whether A is the same: masses, materials, the time step and what handles hold are in it.
std::uint64_t system_of(const Model& model, CarryingWork& work) {
  if (work.system_for != model.id) {
    const auto bytes = sizeof(double) * static_cast<std::size_t>(model.matrix.nonZeros());
    work.system = hash_bytes(model.matrix.valuePtr(), bytes);
    work.system_for = model.id;
  }
  return work.system;
}

}  // namespace

void choose_carried_pair(const Model& model, const SolverSettings& solver, const State& state, Workspace& w) {
  CarryingWork& work = w.carrying;
  work.wanted = solver.carry && solver.history > 0;
  work.used = work.misled = work.touches = false;
  work.searches = 0;
  work.from = nullptr;
  if (!work.wanted) return;
  work.step.resize(model.free, 3);
  work.gradient.resize(model.free, 3);
  const CarriedPair& pair = state.carried;
  const bool of_this_body = system_of(model, work) == pair.system && pair.step.rows() == model.free;
  if (of_this_body && pair.wait == 0) work.from = &pair;
}

void remember_carried_pair(Workspace& w, State& state) {
  CarryingWork& work = w.carrying;
  if (!work.wanted) {
    state.carried = {};
    return;
  }
  CarriedPair& pair = state.carried;
  if (pair.system != work.system) pair = {};
  pair.system = work.system;
  if (pair.wait > 0) {
    --pair.wait;
  } else if (work.used && w.report.iterations > 0) {
    pair.misses = work.misled ? std::min(pair.misses + 1, most_misses) : 0;
    pair.wait = (1 << pair.misses) - 1;
  }
  const bool whole = work.searches == 1 && !work.touches && w.report.error_estimate < most_error;
  const double curvature = whole ? work.step.cwiseProduct(work.gradient).sum() : 0;
  if (is_safely_positive(curvature, work.step.squaredNorm(), work.gradient.squaredNorm())) {
    pair.step = work.step;
    pair.gradient = work.gradient;
    return;
  }
  pair.wait = std::max(pair.wait, 1);  // what stays there is memory for a later pair, and does not serve
  if (pair.step.rows() == work.step.rows()) return;
  pair.step.setZero(work.step.rows(), 3);
  pair.gradient.setZero(work.step.rows(), 3);
}

}  // namespace supple
