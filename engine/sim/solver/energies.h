// The energies of a body at a state, for reports. Outside the step, so not in its time.
#pragma once

#include "sim/model/state.h"
#include "sim/solver/objective.h"

namespace supple {

struct Energies {
  double kinetic = 0, elastic = 0, gravitational = 0;  // the last one against the rest shape [J]
  double total() const { return kinetic + elastic + gravitational; }
};
// Springs of soft handles are not counted. Evaluates all elements; the workspace must be prepared for the model.
Energies energies(const Model& model, const State& state, const Vec3& gravity, Workspace& workspace);

}  // namespace supple
