#include "app/solvers.h"

#include "baselines/joined_reference.h"
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
    return {error, motion, true};
  }

 private:
  Reference reference_;
  OpenWorkspace workspace_;
};

std::vector<MeasuredErrors> errors_of_parts(const Model& joined, const StepInputs& inputs, const State& before,
                                            const State& after, Threads& threads) {
  OpenWorkspace workspace;
  workspace.threads = &threads;
  const JoinedErrors errors = joined_errors(joined, inputs, before, after, workspace);
  std::vector<MeasuredErrors> list;
  for (const double motion : errors.motion) list.push_back({errors.error, motion, errors.converged});
  return list;
}

}  // namespace

FilmSolvers all_solvers() {
  return {{make_rule, settings_of},
          [](const Model& model, Threads& threads) { return std::make_unique<ReferenceMeter>(model, threads); },
          errors_of_parts};
}

}  // namespace supple
