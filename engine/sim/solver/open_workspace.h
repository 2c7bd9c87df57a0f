// Holds the memory in which step() works, allocated once and reused, for the solver's own files and for those who look
// into a step. Nothing that remains in it from earlier steps changes a result. Other programs have a Workspace, which
// holds one (workspace.h).
#pragma once

#include <functional>
#include <optional>

#include "base/threads.h"
#include "sim/air/air_forces.h"
#include "sim/air/gas_solve.h"
#include "sim/coarse/second_level.h"
#include "sim/coarse/turning.h"
#include "sim/contact/contact_direction.h"
#include "sim/contact/find_contacts.h"
#include "sim/model/bending.h"
#include "sim/model/report.h"
#include "sim/model/tangent_system.h"
#include "sim/model/turned_hessian_system.h"
#include "sim/solver/direction_lengths.h"
#include "sim/solver/iterate.h"
#include "sim/solver/newton_system.h"
#include "sim/solver/step_clock.h"

namespace supple {

// Holds the memory of one body, or of one thread that makes steps; prepare() adapts it to another model.
struct OpenWorkspace {
  // Allocates memory for a model and a window; does nothing when there is enough.
  void prepare(const Model& model, const SolverSettings& solver);

  Threads* threads = nullptr;  // may be null: one thread

  // The following members hold the step's problem.
  Positions y;                                 // inertial prediction, n x 3 [m]
  const Positions* start_positions = nullptr;  // q, where the step starts: the caller's, n x 3 [m]
  Positions start_copy;                        // a copy of q, n x 3 [m]; empty unless the model's forces depend on q
  AirForces air;                               // forces of air and gas in the step; none where StepInputs::air is empty
  Positions target;  // targets of soft handles, by free vertex, n_free x 3 [m]; empty without soft handles
  // How far apart the places that seams join are meant to be where forces are evaluated, pairs x 3 [m].
  Positions seam_gaps;

  std::optional<double> contact_energy_at_y;  // once a step has asked for it [J]

  // The solver is at the current iterate, and tries the trial iterate.
  Iterate current, trial;
  // The precision in which the elements of iterates are evaluated (element_precision.h). Outside of searches it is
  // double.
  Precision elements = Precision::double_precision;
  bool began_in_single = false;    // whether the first direction of the step was worth single precision
  bool is_last_iteration = false;  // whether the present iteration is the last one that its search may make
  Positions direction;             // from the current iterate, n_free x 3 [m]

  // The matrix that directions of the present step start from: the model's own A, or the one that follows the body.
  // Where turned_hessian_serves is true, directions from iterates without contacts start from the turned Hessian
  // instead.
  const System* system = nullptr;
  TangentSystem tangent;
  TurnedHessianSystem turned_hessian;
  bool turned_hessian_serves = false;
  Positions next_matrix_at;  // q + h v, where a matrix is made if this step makes one, n x 3 [m]
  bool renewed = false;      // whether this step made one

  // The second level of directions, and the arcs by which parts of the body turn; empty until a step asks for them.
  SecondLevel second_level;
  bool second_level_serves = false;  // whether the present search uses the second level
  Turning turning;
  Positions motion;       // h v, n x 3 [m]
  Positions turned;       // how the turning parts depart from q + h v, n_free x 3 [m]
  bool turns = false;     // whether parts turn so much that the first iterates have `turned` in them
  Positions bow;          // how the present search departs from its straight direction, n_free x 3 [m]
  bool is_bowed = false;  // whether the present search has such an arc

  NewtonSystem newton;  // empty until Newton's method finishes a step

  // The pairs of L-BFGS are stored in a ring.
  std::vector<Positions> step_pairs, gradient_pairs;  // s [m] and t [N]
  std::vector<double> products;                       // s_i . t_j, window x window [J]

  DirectionLengths lengths;  // of the directions of the present search, and of Newton's method after it

  ContactWork contact;
  ContactCorrection correction;
  GasSolve gas;  // of the last direction, where a part holds a fixed amount of gas

  // The following members are memory within one call and hold nothing between calls.
  Positions middle;             // where forces are evaluated, n x 3 [m]; empty where that is the iterate itself
  Positions reference_middle;   // the same for the current iterate; empty without bending and seams
  BendingRoom bent;             // forces of bending
  CurvatureRoom curvature;      // forces of cloth that is curved at rest
  Positions scratch;            // n_free x 3
  AlignedVector<double> force;  // by slot, x list_stride [N]
  AlignedVector<double> local;  // positions by chunk, x list_stride [m]
  SolveScratch solve_scratch;
  std::vector<double> partial;  // partial sums, by chunk

  StepReport report;
  StepClock clock;
  // Called with every iterate of a step, n x 3, when solvers are compared; empty: nobody looks.
  std::function<void(const Positions& x)> watch;

 private:
  std::uint64_t prepared_for_ = 0;  // Model::id
  int window_ = -1;
};

}  // namespace supple
