// Offers the step to other programs, with memory that they need not look into.
#pragma once

#include <memory>

#include "base/threads.h"
#include "sim/model/inputs.h"
#include "sim/model/model.h"
#include "sim/model/report.h"
#include "sim/model/state.h"

namespace supple {

struct OpenWorkspace;

// Holds the memory in which steps are made: scratch that never changes a result. One body, or one thread that makes
// steps, has one.
class Workspace {
 public:
  // threads: null for the calling thread alone; they must outlive the workspace.
  explicit Workspace(Threads* threads = nullptr);
  ~Workspace();
  Workspace(Workspace&&) noexcept;
  Workspace& operator=(Workspace&&) noexcept;

  const StepReport& report() const;  // of the last step
  OpenWorkspace& open() { return *open_; }
  const OpenWorkspace& open() const { return *open_; }

 private:
  std::unique_ptr<OpenWorkspace> open_;
};

// Makes a step by quasi-Newton iterations, as step() in sim/solver/step.h says. The report is that of the workspace.
const StepReport& step(const Model& model, const StepInputs& inputs, State& state, Workspace& workspace);

}  // namespace supple
