// Holds the memory in which step() works, allocated once and reused. Nothing that remains in it from earlier steps
// changes a result.
#pragma once

#include <functional>

#include "base/threads.h"
#include "sim/coarse/second_level.h"
#include "sim/coarse/turning.h"
#include "sim/contact/contact_direction.h"
#include "sim/contact/find_contacts.h"
#include "sim/model/hessian_system.h"
#include "sim/model/report.h"
#include "sim/model/tangent_system.h"
#include "sim/solver/iterate.h"
#include "sim/solver/newton_system.h"
#include "sim/solver/step_clock.h"

namespace supple {

// Each body, or each thread that makes steps, needs one; prepare() adapts it to another model.
struct Workspace {
  // Allocates memory for a model and a window; does nothing when there is enough.
  void prepare(const Model& model, const SolverSettings& solver);

  Threads* threads = nullptr;  // may be null: one thread

  // The following members hold the step's problem.
  Positions y;                                 // inertial prediction, n x 3 [m]
  const Positions* start_positions = nullptr;  // q, where the step starts: the caller's, n x 3 [m]
  Positions start_copy;                        // a copy of them, n x 3 [m]; empty unless the model's forces depend on q
  Positions target;  // of soft handles, by free vertex, n_free x 3 [m]; empty when there are none

  // These are the point at which the solver is, and the one that it tries.
  Iterate current, trial;
  Positions direction;  // from the current iterate, n_free x 3 [m]

  // The matrix that directions start from, of the step in hand: the model's own A, or the one that follows the body. In
  // its place the Hessian serves directions from iterates without contacts, where hessian_serves.
  const System* system = nullptr;
  TangentSystem tangent;
  HessianSystem hessian;
  bool hessian_serves = false;
  Positions next_matrix_at;  // q + h v, where a matrix is made if this step makes one, n x 3 [m]
  bool renewed = false;      // it did

  // The second level of directions, and the arcs by which parts of the body turn; empty until a step asks for them.
  SecondLevel second_level;
  bool second_level_serves = false;  // in the search in hand
  Turning turning;
  Positions motion;       // h v, n x 3 [m]
  Positions turned;       // how what turns departs from q + h v, n_free x 3 [m]
  bool turns = false;     // it does, by so much that the first iterates have `turned` in them
  Positions bow;          // how the search in hand departs from its straight direction, n_free x 3 [m]
  bool is_bowed = false;  // it does

  NewtonSystem newton;  // empty until a step is finished by it

  // The pairs of L-BFGS are stored in a ring.
  std::vector<Positions> step_pairs, gradient_pairs;  // s [m] and t [N]
  std::vector<double> products;                       // s_i . t_j, window x window [J]

  ContactWork contact;
  ContactCorrection correction;

  // The following members are memory within one call and hold nothing between calls.
  Positions middle;             // where forces are evaluated, n x 3 [m]; empty unless that is not the iterate
  Positions scratch;            // n_free x 3
  AlignedVector<double> force;  // by slot, x 3 [N]
  AlignedVector<double> local;  // positions by chunk, x 3 [m]
  SolveScratch solve_scratch;
  std::vector<double> partial;  // of chunked sums

  StepReport report;
  StepClock clock;
  // Is shown every iterate of a step, n x 3, by those who compare solvers; empty: nobody looks.
  std::function<void(const Positions& x)> watch;

 private:
  std::uint64_t prepared_for_ = 0;  // Model::id
  int window_ = -1;
};

}  // namespace supple
