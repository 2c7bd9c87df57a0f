// Describes the problem of one step alone: all on which g of equation 3 depends, without contact, air and gas, in the
// order of the input file instead of the model's. It serves comparisons of solvers on stored states, and other
// programs. Not here: files (film/record/state_file.h).
#pragma once

#include "sim/model/inputs.h"
#include "sim/model/model.h"
#include "sim/model/state.h"

namespace supple {

struct StepProblem {
  BodyDescription body;           // mesh, materials, fibres, springs, h, integrator, damping
  std::vector<double> stiffness;  // k of equation 11 by region, which damping uses [Pa]
  std::vector<double> mass;       // by vertex [kg]
  double time = 0;                // at the start of the step [s]
  Vec3 gravity = Vec3(0, 0, 0);   // [m/s^2]
  Positions q, v, y;              // start, its velocities, and where inertia alone leads, n x 3 [m], [m/s], [m]
  std::uint64_t hash = 0;         // state_hash of q and v
  bool began_in_single = false;   // whether the step before was worth single precision (solver/element_precision.h)
  SolverSettings solver;

  struct Handled {
    std::int32_t vertex;
    double stiffness;  // of the spring to the target [N/m]; 0: the vertex is held there, and no unknown
  };
  std::vector<Handled> handled;
  Positions targets;         // at the end of the step, by `handled` [m]
  Positions middle_targets;  // halfway, where implicit midpoint's springs end [m]; empty for backward Euler

  // The pairs that seams join, with their stiffness. `gap` is the one that is meant where the step evaluates forces,
  // not that at the start.
  std::vector<SeamPair> seams;

  struct Obstacle {
    std::string name;
    double thickness;  // [m]
    double friction;
    ColliderMotion motion;
  };
  std::vector<Obstacle> colliders;
};

// Returns the problem of the step that starts at `state` with these inputs. body: the description from which the model
// was built.
StepProblem problem_of(const BodyDescription& body, const Model& model, const StepInputs& inputs, const State& state);

}  // namespace supple
