#include "sim/solver/workspace.h"

#include "sim/solver/step.h"

namespace supple {

Workspace::Workspace(Threads* threads) : open_(std::make_unique<OpenWorkspace>()) { open_->threads = threads; }
Workspace::~Workspace() = default;
Workspace::Workspace(Workspace&&) noexcept = default;
Workspace& Workspace::operator=(Workspace&&) noexcept = default;

const StepReport& Workspace::report() const { return open_->report; }

const StepReport& step(const Model& model, const StepInputs& inputs, State& state, Workspace& workspace) {
  return step(model, inputs, state, workspace.open());
}

}  // namespace supple
