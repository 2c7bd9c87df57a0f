#include "app/solvers.h"

#include "baselines/make_rule.h"
#include "baselines/reference.h"

namespace supple {
namespace {

// Measures errors against the minimum that the reference finds.
class ReferenceMeter : public ErrorMeter {
 public:
  ReferenceMeter(const Model& model, Threads& threads) : reference_(model) { workspace_.threads = &threads; }

  MeasuredErrors step_errors(const Model& model, const StepInputs& inputs, const State& before,
                             const State& after) override {
    const auto [error, motion] = reference_.step_errors(model, inputs, before, after, workspace_);
    return {error, motion};
  }

 private:
  Reference reference_;
  OpenWorkspace workspace_;
};

}  // namespace

FilmSolvers all_solvers() {
  return {{make_rule, settings_of},
          [](const Model& model, Threads& threads) { return std::make_unique<ReferenceMeter>(model, threads); }};
}

}  // namespace supple
