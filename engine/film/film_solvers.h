// Holds the solvers that a film uses. They are passed in, because this library does not depend on the one that contains
// them.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "scene/driven_body.h"

namespace supple {

// Measures the error of one body's steps against the converged solution.
class ErrorMeter {
 public:
  virtual ~ErrorMeter() = default;

  // Evaluates equation 12 for a step from `before` to `after`. Returns nothing where the objective of the start is
  // above its minimum by round-off alone.
  virtual std::optional<double> step_error(const Model& model, const StepInputs& inputs, const State& before,
                                           const State& after) = 0;
};

struct FilmSolvers {
  Solvers steps;
  // A meter is valid as long as the model's values do not change.
  std::function<std::unique_ptr<ErrorMeter>(const Model&, Threads&)> error_meter;
};

}  // namespace supple
