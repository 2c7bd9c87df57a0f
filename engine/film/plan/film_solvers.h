// Holds the solvers that a film uses. They are passed in, because this library does not depend on the library that
// contains them.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "base/threads.h"
#include "world/solvers.h"

namespace supple {

struct State;

// Holds the measured errors of a step.
struct MeasuredErrors {
  // The error of equation 12; nothing where the start's objective is above its minimum by round-off alone.
  std::optional<double> error;
  double motion = 0;      // the error of motion (sim/model/motion_error.h)
  bool converged = true;  // false: the reference may be above the minimum, and the true errors larger than these
};

// Measures the errors of the steps that one body makes by itself, against the converged solution.
class ErrorMeter {
 public:
  virtual ~ErrorMeter() = default;

  // Measures a step from `before` to `after`.
  virtual MeasuredErrors step_errors(const Model& model, const StepInputs& inputs, const State& before,
                                     const State& after) = 0;
};

struct FilmSolvers {
  Solvers steps;
  // Makes a meter, which is valid as long as the model's values do not change.
  std::function<std::unique_ptr<ErrorMeter>(const Model&, Threads&)> error_meter;
  // Measures a step that bodies made together, from `before` to `after`, and returns the errors of each part of their
  // joined model.
  std::function<std::vector<MeasuredErrors>(const Model& joined, const StepInputs& inputs, const State& before,
                                            const State& after, Threads& threads)>
      joined_errors;
};

}  // namespace supple
