#include "baselines/make_rule.h"

#include <algorithm>

#include "baselines/initial_hessians.h"
#include "baselines/newton.h"

namespace supple {
namespace {

// L-BFGS together with the initial Hessian that it starts from.
template <class Inverse>
class LbfgsFrom final : public SearchRule {
 public:
  template <class... Arguments>
  explicit LbfgsFrom(const Arguments&... arguments) : inverse_(arguments...), rule_(inverse_) {}
  void begin(const Model& model, const FrameInputs& inputs, Workspace& w) override { rule_.begin(model, inputs, w); }
  double direction(const Model& model, const FrameInputs& inputs, Workspace& w) override {
    return rule_.direction(model, inputs, w);
  }
  void accepted(const Model& model, const FrameInputs& inputs, Workspace& w) override {
    rule_.accepted(model, inputs, w);
  }
  void contacts_changed(const FrameInputs& inputs) override { rule_.contacts_changed(inputs); }
  bool forget() override { return rule_.forget(); }

 private:
  Inverse inverse_;
  LbfgsRule rule_;
};

// Chebyshev semi-iterative acceleration (Wang 2015, "A Chebyshev semi-iterative approach for accelerating projective
// and position-based dynamics"; Liu et al. 2017, algorithm 3). After an ascent it starts anew.
class ChebyshevRule final : public SearchRule {
 public:
  explicit ChebyshevRule(const RuleSettings& settings) : settings_(settings) {}

  void begin(const Model&, const FrameInputs&, Workspace&) override { iteration_ = 0; }

  double direction(const Model& model, const FrameInputs& inputs, Workspace& w) override {
    const Stretch stretch(w.clock, Phase::solve, "solve");
    w.scratch = w.current.gradient;
    find_stiff_directions(model, w.current.contacts, w.current.x, w.contact.stick_length, w.correction);
    apply_inverse(model, inputs.solver.contact, w.correction, w.solve_scratch, w.scratch, w.direction);
    w.direction = -w.direction;
    const double rho2 = settings_.chebyshev_radius * settings_.chebyshev_radius;
    if (iteration_ < settings_.chebyshev_delay) {
      omega_ = 1;
    } else if (iteration_ == settings_.chebyshev_delay) {
      omega_ = 2 / (2 - rho2);
    } else {
      omega_ = 4 / (4 - rho2 * omega_);
    }
    // omega (x_{k+1} - x_{k-1}) + x_{k-1} - x_k with x_{k+1} = x_k + q
    if (iteration_ > 0)
      w.direction =
          omega_ * w.direction + (omega_ - 1) * (w.current.x.topRows(model.free) - before_.topRows(model.free));
    return (w.current.gradient.array() * w.direction.array()).sum();
  }

  void accepted(const Model&, const FrameInputs&, Workspace& w) override {
    before_ = w.current.x;
    ++iteration_;
  }

  bool forget() override { return std::exchange(iteration_, 0) > 0; }

 private:
  RuleSettings settings_;
  int iteration_ = 0;
  double omega_ = 1;
  Positions before_;
};

constexpr int gast_iterations = 100;     // at most; indefiniteness or the tolerance usually come first
constexpr double gast_tolerance = 0.05;  // of the residual

}  // namespace

std::unique_ptr<SearchRule> make_rule(Method method, const Model& model, const RuleSettings& settings) {
  using Preconditioner = FrameCgInverse::Preconditioner;
  switch (method) {
    case Method::quasi_newton:
    case Method::projective_dynamics: return std::make_unique<LbfgsFrom<SystemInverse>>();
    case Method::chebyshev: return std::make_unique<ChebyshevRule>(settings);
    case Method::newton: return std::make_unique<NewtonRule>(model, Definite::projected);
    case Method::newton_shifted: return std::make_unique<NewtonRule>(model, Definite::shifted);
    case Method::newton_cg5: return std::make_unique<NewtonCgRule>(model, true, 5, 0.0);
    case Method::newton_cg15: return std::make_unique<NewtonCgRule>(model, true, 15, 0.0);
    case Method::gast: return std::make_unique<NewtonCgRule>(model, false, gast_iterations, gast_tolerance);
    case Method::quasi_newton_cg5: return std::make_unique<LbfgsFrom<SystemCgInverse>>(model, 5);
    case Method::quasi_newton_cg15: return std::make_unique<LbfgsFrom<SystemCgInverse>>(model, 15);
    case Method::lbfgs_identity: return std::make_unique<LbfgsFrom<IdentityInverse>>();
    case Method::lbfgs_rest: return std::make_unique<LbfgsFrom<RestInverse>>(model);
    case Method::lbfgs_warped: return std::make_unique<LbfgsFrom<WarpedInverse>>(model);
    case Method::lbfgs_frame: return std::make_unique<LbfgsFrom<FrameInverse>>(model);
    case Method::lbfgs_frame_cg5_rest:
      return std::make_unique<LbfgsFrom<FrameCgInverse>>(model, Preconditioner::rest, 5);
    case Method::lbfgs_frame_cg15_rest:
      return std::make_unique<LbfgsFrom<FrameCgInverse>>(model, Preconditioner::rest, 15);
    case Method::lbfgs_frame_cg5_ours:
      return std::make_unique<LbfgsFrom<FrameCgInverse>>(model, Preconditioner::ours, 5);
    case Method::lbfgs_frame_cg15_ours:
      return std::make_unique<LbfgsFrom<FrameCgInverse>>(model, Preconditioner::ours, 15);
    case Method::hecht: return std::make_unique<LbfgsFrom<HechtInverse>>(model);
    case Method::contact_matrix: return std::make_unique<LbfgsFrom<ContactMatrixInverse>>(model);
  }
  return nullptr;
}

SolverSettings settings_of(Method method, SolverSettings settings) {
  switch (method) {
    case Method::projective_dynamics:
    case Method::chebyshev:
    case Method::newton:
    case Method::newton_shifted:
    case Method::newton_cg5:
    case Method::newton_cg15:
    case Method::gast: settings.history = 0; break;
    case Method::hecht:
      settings.history = 0;
      settings.line_search = LineSearch::none;
      break;
    default: break;
  }
  return settings;
}

}  // namespace supple
