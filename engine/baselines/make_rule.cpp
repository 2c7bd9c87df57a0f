#include "baselines/make_rule.h"

#include <utility>

#include "base/error.h"
#include "baselines/chebyshev_weight.h"
#include "baselines/initial_hessians.h"
#include "baselines/newton.h"
#include "baselines/splitting.h"
#include "baselines/vertex_blocks.h"

namespace supple {
namespace {

std::unique_ptr<InitialInverse> initial_inverse(const Method& method, const Model& model) {
  const bool cg = method.linear == LinearSolver::cg;
  switch (method.matrix) {
    case StartMatrix::system:
      if (cg) return std::make_unique<SystemCgInverse>(model, method.inner_iterations);
      return std::make_unique<SystemInverse>();
    case StartMatrix::identity: return std::make_unique<IdentityInverse>();
    case StartMatrix::rest_hessian: return std::make_unique<HessianInverse>(model, rest_hessian_source);
    case StartMatrix::warped_rest_hessian: return std::make_unique<HessianInverse>(model, warped_hessian_source);
    case StartMatrix::frame_hessian:
      if (cg) return std::make_unique<FrameCgInverse>(model, method.preconditioner, method.inner_iterations);
      return std::make_unique<HessianInverse>(model, frame_hessian_source);
    case StartMatrix::tangent:
    case StartMatrix::turned_hessian: break;  // no method has them (problem_of)
    case StartMatrix::hessian:
    case StartMatrix::vertex_blocks: break;  // the rules of Newton's method and of vertex blocks hold these
  }
  return nullptr;
}

// Combines L-BFGS with the initial Hessian from which it starts. Without pairs (settings_of) the direction follows from
// that Hessian alone.
class LbfgsFrom final : public SearchRule {
 public:
  explicit LbfgsFrom(std::unique_ptr<InitialInverse> inverse) : inverse_(std::move(inverse)), rule_(*inverse_) {}
  void begin(const Model& model, const StepInputs& inputs, OpenWorkspace& w) override { rule_.begin(model, inputs, w); }
  double direction(const Model& model, const StepInputs& inputs, OpenWorkspace& w) override {
    return rule_.direction(model, inputs, w);
  }
  void accepted(const Model& model, const StepInputs& inputs, OpenWorkspace& w) override {
    rule_.accepted(model, inputs, w);
  }
  bool measures_last_iterate() const override { return rule_.measures_last_iterate(); }
  bool takes_single() const override { return rule_.takes_single(); }
  bool forget() override { return rule_.forget(); }

 private:
  std::unique_ptr<InitialInverse> inverse_;
  LbfgsRule rule_;
};

// Implements Projective Dynamics with Chebyshev's acceleration (Wang 2015; Liu et al. 2017, algorithm 3). After an
// ascent the acceleration starts again.
class ChebyshevRule final : public SearchRule {
 public:
  void begin(const Model&, const StepInputs&, OpenWorkspace&) override { iteration_ = 0; }

  double direction(const Model& model, const StepInputs& inputs, OpenWorkspace& w) override {
    const TimedPhase timed(w.clock, Phase::solve, "solve");
    w.scratch = w.current.gradient;
    find_stiff_directions(model, w.current.contacts, w.current.x, w.correction);
    apply_inverse(model, inputs.solver.contact, w.correction, w.solve_scratch, w.scratch, w.direction);
    w.direction = -w.direction;
    tried_ = chebyshev_weight(inputs.solver.chebyshev, iteration_, omega_);
    // omega (x_{k+1} - x_{k-1}) + x_{k-1} - x_k with x_{k+1} = x_k + q
    if (iteration_ > 0)
      w.direction =
          tried_ * w.direction + (tried_ - 1) * (w.current.x.topRows(model.free) - before_.topRows(model.free));
    return (w.current.gradient.array() * w.direction.array()).sum();
  }

  void accepted(const Model&, const StepInputs&, OpenWorkspace& w) override {
    before_ = w.current.x;
    omega_ = tried_;
    ++iteration_;
  }
  bool takes_single() const override { return true; }

  bool forget() override { return std::exchange(iteration_, 0) > 0; }

 private:
  int iteration_ = 0;
  double omega_ = 1, tried_ = 1;  // weights of the last iteration, and of the last direction
  Positions before_;
};

std::unique_ptr<SearchRule> newton_rule(const Method& method, const Model& model) {
  if (method.linear == LinearSolver::direct) return std::make_unique<NewtonRule>(model, method.safeguard);
  const bool project = method.safeguard == Safeguard::projection;
  return std::make_unique<NewtonCgRule>(model, project, method.inner_iterations, method.inner_tolerance);
}

}  // namespace

std::optional<std::string> why_unsuited(const Method& method, const Model& model) {
  if (method.acceleration == Acceleration::admm && !model.fabrics.empty())
    return "admm: has no local step for the triangles of cloth, which body '" + model.name + "' has";
  if (method.matrix == StartMatrix::vertex_blocks && !model.curvature.empty())
    return "vertex blocks: have no local step for cloth that is curved at rest, which body '" + model.name + "' has";
  return std::nullopt;
}

std::unique_ptr<SearchRule> make_rule(const Method& method, const Model& model) {
  if (const auto problem = problem_of(method)) throw InputError("method", problem->message);
  if (const auto reason = why_unsuited(method, model)) throw InputError("method", *reason);
  const bool chebyshev = method.acceleration == Acceleration::chebyshev;
  if (method.matrix == StartMatrix::vertex_blocks) return std::make_unique<VertexBlockRule>(model, chebyshev);
  if (method.acceleration == Acceleration::admm) return std::make_unique<SplittingRule>();
  if (chebyshev) return std::make_unique<ChebyshevRule>();
  if (method.matrix == StartMatrix::hessian) return newton_rule(method, model);
  return std::make_unique<LbfgsFrom>(initial_inverse(method, model));
}

SolverSettings settings_of(const Method& method, SolverSettings settings) {
  if (method.acceleration != Acceleration::lbfgs) settings.history = 0;
  if (method != Method::quasi_newton) {
    settings.matrix = StartMatrix::system;
    settings.levels = 1;
    settings.newton = false;
  }
  if (method.matrix == StartMatrix::vertex_blocks || method.acceleration == Acceleration::admm)
    settings.line_search = LineSearch::none;
  return settings;
}

std::vector<Method> compared_methods() {
  std::vector<Method> methods;
  for (const ShortName& entry : short_names) methods.push_back(entry.method);
  methods.push_back(Method::newton_shifted);
  methods.push_back(Method::newton_on_demand);
  for (const StartMatrix matrix :
       {StartMatrix::identity, StartMatrix::rest_hessian, StartMatrix::warped_rest_hessian, StartMatrix::frame_hessian})
    methods.push_back(Method::lbfgs_from(matrix));
  for (const int iterations : {5, 15}) {
    methods.push_back(Method::quasi_newton_cg(iterations));
    methods.push_back(Method::newton_cg(iterations));
    for (const Preconditioner preconditioner : {Preconditioner::rest, Preconditioner::system})
      methods.push_back(Method::frame_cg(iterations, preconditioner));
  }
  return methods;
}

}  // namespace supple
