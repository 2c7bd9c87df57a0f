// Finds the converged reference for a step that several bodies made together (sim/model/joined_model.h). Newton's
// method, which solves the reference of a body alone (reference.h), has no room for contacts between bodies, so
// quasi-Newton iterations continue from the step's end until their own estimates say that nothing is left. As for a
// body alone, contacts are found anew at each iterate, from the same beginning of the step, and g counts those that are
// found where it is evaluated.
#pragma once

#include <optional>
#include <vector>

#include "sim/model/inputs.h"
#include "sim/model/model.h"
#include "sim/model/state.h"
#include "sim/solver/open_workspace.h"

namespace supple {

// Holds the errors of a step of several bodies.
struct JoinedErrors {
  std::optional<double> error;  // of equation 12, of all bodies together; nothing where g(y) - g* is round-off
  std::vector<double> motion;   // the error of motion of each part (sim/model/motion_error.h)
  // Tells whether what is left to gain is estimated as less than 1e-10 of g(y) - g*, and the way that is left as less
  // than 1e-5 of each body's motion, or both as round-off. Where not, the errors are those against the lowest iterate
  // that was found.
  bool converged = false;
};

// Measures the step of a joined model. `before` and `after` are the states around it; their anchors and memory may be
// empty. workspace: scratch memory for the reference alone.
JoinedErrors joined_errors(const Model& model, const StepInputs& inputs, const State& before, const State& after,
                           OpenWorkspace& workspace);

}  // namespace supple
