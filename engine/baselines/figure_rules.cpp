#include "baselines/figure_rules.h"

#include "baselines/initial_hessians.h"
#include "baselines/make_rule.h"

namespace supple {
namespace {

class HechtRule final : public SearchRule {
 public:
  explicit HechtRule(const Model& model) : inverse_(model, hecht_hessian_source) {}
  void begin(const Model& model, const StepInputs& inputs, Workspace& w) override { inverse_.begin(model, inputs, w); }
  double direction(const Model& model, const StepInputs& inputs, Workspace& w) override {
    const TimedPhase timed(w.clock, Phase::solve, "solve");
    w.scratch = w.current.gradient;
    inverse_.apply(model, inputs, w, w.scratch, w.direction);
    w.direction = -w.direction;
    return (w.current.gradient.array() * w.direction.array()).sum();
  }

 private:
  HessianInverse inverse_;
};

}  // namespace

std::unique_ptr<SearchRule> make_hecht_rule(const Model& model) { return std::make_unique<HechtRule>(model); }

SolverSettings hecht_settings(SolverSettings settings) {
  settings = settings_of(Method::lbfgs_from(StartMatrix::warped_rest_hessian), settings);
  settings.history = 0;
  settings.line_search = LineSearch::none;
  return settings;
}

}  // namespace supple
