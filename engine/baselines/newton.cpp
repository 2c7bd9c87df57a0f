#include "baselines/newton.h"

#include "base/error.h"

namespace supple {
namespace {

constexpr int most_tries = 60;  // doublings of the shift

double slope_of(const OpenWorkspace& w) { return (w.current.gradient.array() * w.direction.array()).sum(); }

}  // namespace

NewtonRule::NewtonRule(const Model& model, Safeguard safeguard) : safeguard_(safeguard), hessian_(model) {
  factor_.analyze(hessian_.matrix());
}

double NewtonRule::direction(const Model& model, const StepInputs&, OpenWorkspace& w) {
  const TimedPhase timed(w.clock, Phase::solve, "Newton");
  hessian_.assemble(model, w, safeguard_ == Safeguard::projection);
  switch (safeguard_) {
    case Safeguard::projection: factorize_projected(hessian_, factor_); break;
    case Safeguard::on_demand: factorize_on_demand(model, w); break;
    default: factorize_shifted(); break;
  }
  factor_.solve(w.current.gradient.data(), w.direction.data());
  if (w.air.fixed_amounts() > 0) {
    w.gas.begin(model, w.air, w.current.x,
                [&](const Positions& force, Positions& motion) { factor_.solve(force.data(), motion.data()); });
    w.gas.correct(w.direction);
  }
  w.direction = -w.direction;
  return slope_of(w);
}

// Factors the Hessian as it is, or with projected elements where that fails (Longva et al. 2023, "Pitfalls of
// projection: a study of Newton-type solvers for incremental potentials", Project-on-Demand Newton). Each iteration
// decides for itself.
void NewtonRule::factorize_on_demand(const Model& model, OpenWorkspace& w) {
  if (factor_.factorize(hessian_.matrix())) return;
  hessian_.assemble(model, w, true);
  factorize_projected(hessian_, factor_);
}

// Follows Nocedal and Wright 2006, algorithm 3.3; the next iteration first tries half of the shift that this one
// needed.
void NewtonRule::factorize_shifted() {
  const double least = 1e-3 * hessian_.matrix().diagonal().cwiseAbs().mean();
  double shift = shift_ / 2 < least ? 0 : shift_ / 2, added = 0;
  for (int tries = 0;; ++tries) {
    if (tries == most_tries) throw RunError("Newton's method: no shift makes the Hessian positive definite");
    hessian_.shift(shift - added);
    added = shift;
    if (factor_.factorize(hessian_.matrix())) break;
    shift = std::max(2 * shift, least);
  }
  shift_ = shift;
}

NewtonCgRule::NewtonCgRule(const Model& model, bool project, int iterations, double tolerance)
    : project_(project), iterations_(iterations), tolerance_(tolerance), hessian_(model) {}

// The rank-one shares of fixed amounts of gas (sim/air/gas_solve.h) are left out here: directions then change the
// volume too much, and the line search shortens them.
double NewtonCgRule::direction(const Model& model, const StepInputs&, OpenWorkspace& w) {
  const TimedPhase timed(w.clock, Phase::solve, "Newton");
  hessian_.assemble(model, w, project_);
  const Eigen::Index count = 3 * model.free;
  right_ = -Eigen::Map<const Eigen::VectorXd>(w.current.gradient.data(), count);
  diagonal_ = hessian_.matrix().diagonal();
  // An unprojected diagonal may have negative entries; only their magnitudes serve as scale.
  diagonal_ = diagonal_.cwiseAbs().cwiseMax(1e-12 * diagonal_.cwiseAbs().maxCoeff());
  conjugate_gradients(
      right_, solution_, iterations_, tolerance_,
      [&](const Eigen::VectorXd& v, Eigen::VectorXd& result) { hessian_.multiply(v.data(), result.data()); },
      [&](const Eigen::VectorXd& r, Eigen::VectorXd& z) { z = r.cwiseQuotient(diagonal_); }, scratch_);
  Eigen::Map<Eigen::VectorXd>(w.direction.data(), count) = solution_;
  return slope_of(w);
}

}  // namespace supple
