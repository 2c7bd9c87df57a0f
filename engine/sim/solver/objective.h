// Evaluates g(x) of equation 3, or of another integrator or with damping, at iterates: values, value differences
// without cancellation (within one precision), and gradients, in a fixed order of summation. Contacts are added as
// contact.h has them, and air as sim/air/air_forces.h has it. Not here: where to evaluate next (lbfgs.h for directions,
// line_search.h for points along them, iterations.h for the loop).
#pragma once

#include "sim/solver/open_workspace.h"

namespace supple {

static_assert(scheme_of(Integrator::backward_euler).energy * scheme_of(Integrator::backward_euler).theta == 1 &&
              scheme_of(Integrator::implicit_midpoint).energy * scheme_of(Integrator::implicit_midpoint).theta == 1);

// Tells whether g depends on q, the start of the step, in another way than through y.
bool needs_start(const Model& model);

enum class Wanted { value, gradient };

// Tells how the trial iterate differs from the current one.
struct Change {
  double value;  // g(trial) - g(current) [J]
  double slope;  // tr(grad(trial)^T direction), where the gradient was wanted [J]
  // Where the trial iterate alone was evaluated in double precision: how far g(current) + value is above g(trial) [J].
  double excess = 0;
};

// Evaluates g at iterate.x with iterate.contacts: sets its g and energies, and its gradient where that is wanted.
void evaluate(const Model& model, OpenWorkspace& workspace, Iterate& iterate, Wanted wanted);

// Evaluates g at workspace.trial.x with the contacts of workspace.current, as its difference from the current iterate,
// summed element by element and vertex by vertex. Also sets trial.g, the trial's energies, and its gradient where that
// is wanted.
Change evaluate_trial(const Model& model, OpenWorkspace& workspace, Wanted wanted);

// Does the same in double precision from a current iterate that was evaluated in single precision: trial.g and its
// energies are evaluated by themselves, and the value is the difference of both g.
Change evaluate_trial_in_double(const Model& model, OpenWorkspace& workspace);

// Returns the round-off of differences of g at a point with this objective and largest coordinate [J].
double noise_of(const Model& model, double objective, double extent);

// Half of the distance between 1 and the next number of single precision.
constexpr double single_round_off = 0x1p-24;

// Returns the round-off of differences of g where elements are evaluated in single precision; elastic: their energy
// [J].
double single_noise_of(const Model& model, double elastic);

// Estimates how far g in single precision is from g in double precision [J]. Elements that are alike are rounded alike,
// and all of them err to one side; between two values of one precision, this mostly cancels.
double single_bias_of(const Model& model, double elastic);

// Returns the share of inertia in g at x, sum of w m |x - y|^2 / (2 h^2), where w is the integrator's weight [J].
double inertial_energy(const Model& model, const OpenWorkspace& workspace, const Positions& x);

// Returns E(x) of all elements and of bending [J]. Overwrites the energies of the trial iterate.
double elastic_energy(const Model& model, OpenWorkspace& workspace, const Positions& x);

// Returns the work that moves held vertices along their ways from q, against the forces of elements, bending and seams
// at x [J]. Evaluates the chunks of elements that have such vertices alone; overwrites energies of the trial iterate.
double work_on_held(const Model& model, OpenWorkspace& workspace, const Positions& x, const Positions& q);

}  // namespace supple
