#include "baselines/figure_rules.h"

#include <deque>
#include <utility>

#include "baselines/initial_hessians.h"
#include "baselines/make_rule.h"

namespace supple {
namespace {

class HechtRule final : public SearchRule {
 public:
  explicit HechtRule(const Model& model) : inverse_(model, hecht_hessian_source) {}
  void begin(const Model& model, const StepInputs& inputs, OpenWorkspace& w) override {
    inverse_.begin(model, inputs, w);
  }
  double direction(const Model& model, const StepInputs& inputs, OpenWorkspace& w) override {
    const TimedPhase timed(w.clock, Phase::solve, "solve");
    w.scratch = w.current.gradient;
    inverse_.apply(model, inputs, w, w.scratch, w.direction);
    w.direction = -w.direction;
    return (w.current.gradient.array() * w.direction.array()).sum();
  }

 private:
  HessianInverse inverse_;
};

class PaperRule final : public SearchRule {
 public:
  void begin(const Model&, const StepInputs& inputs, OpenWorkspace&) override {
    window_ = std::size_t(inputs.solver.history);
    pairs_.clear();
  }

  double direction(const Model& model, const StepInputs&, OpenWorkspace& w) override {
    const TimedPhase timed(w.clock, Phase::solve, "solve");
    Positions &r = w.scratch, &z = w.direction;
    r = w.current.gradient;
    for (Pair& pair : pairs_) {
      pair.alpha = pair.s.cwiseProduct(r).sum() / pair.st;
      r -= pair.alpha * pair.t;
    }
    solve_system(model, r, z, w.solve_scratch);
    for (auto pair = pairs_.rbegin(); pair != pairs_.rend(); ++pair) {
      const double beta = pair->t.cwiseProduct(z).sum() / pair->st;
      z += (pair->alpha - beta) * pair->s;
    }
    z = -z;
    return w.current.gradient.cwiseProduct(z).sum();
  }

  void accepted(const Model& model, const StepInputs&, OpenWorkspace& w) override {
    Pair pair;
    pair.s = (w.trial.x - w.current.x).topRows(model.free);
    pair.t = w.trial.gradient - w.current.gradient;
    pair.st = pair.s.cwiseProduct(pair.t).sum();
    if (!is_safely_positive(pair.st, pair.s.squaredNorm(), pair.t.squaredNorm())) return;
    pairs_.push_front(std::move(pair));
    if (pairs_.size() > window_) pairs_.pop_back();
  }

  bool measures_last_iterate() const override { return true; }
  bool forget() override { return !std::exchange(pairs_, {}).empty(); }

 private:
  struct Pair {
    Positions s, t;  // n_free x 3 [m], [N]
    double st = 0;   // s.t [J]
    double alpha = 0;
  };
  std::size_t window_ = 0;
  std::deque<Pair> pairs_;  // the newest first
};

}  // namespace

std::unique_ptr<SearchRule> make_hecht_rule(const Model& model) { return std::make_unique<HechtRule>(model); }

std::unique_ptr<SearchRule> make_paper_rule(const Model&) { return std::make_unique<PaperRule>(); }

SolverSettings hecht_settings(SolverSettings settings) {
  settings = settings_of(Method::lbfgs_from(StartMatrix::warped_rest_hessian), settings);
  settings.history = 0;
  settings.line_search = LineSearch::none;
  return settings;
}

}  // namespace supple
