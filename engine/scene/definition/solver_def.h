// Defines how a body is solved as a scene describes it.
#pragma once

#include "sim/linear/precision.h"
#include "sim/materials/material.h"
#include "sim/model/inputs.h"
#include "sim/model/method.h"
#include "sim/model/time_scheme.h"

namespace supple {

// Returns the settings that scenes begin with. In films, a step ends early where bodies lie still, because what it
// leaves out cannot be seen ("What lies still" in docs/method.md).
inline SolverSettings settings_of_films() {
  SolverSettings settings;
  settings.still = 1e-6;
  return settings;
}

// Describes how the steps of a body are solved: the table [solver]. `settings` are part of every step's inputs and cost
// nothing to change. The other members are built into the model (fit, precision, integrator, damping: assemble.cpp),
// select the rule for directions (method), or are read by MovingBody (calming, untangle). live_keys.cpp defines what a
// change of each costs.
struct SolverDef {
  Method method = Method::quasi_newton;
  SolverSettings settings = settings_of_films();
  StretchInterval fit;
  Precision precision = Precision::single_precision;
  Integrator integrator = Integrator::backward_euler;
  double damping = 0;     // beta [s]
  double calming = 0;     // rate at which movement within the body dies down (sim/solver/calming.h) [1/s]
  bool untangle = false;  // whether steps that start tangled take the as-rigid-as-possible material (moving_body.h)
};

}  // namespace supple
