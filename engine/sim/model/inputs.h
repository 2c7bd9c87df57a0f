// Defines the inputs of one step: gravity, air, targets of handles, colliders and their motions, and the settings of
// the solver, which may change from step to step.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "base/names.h"
#include "geometry/meshes/pose.h"
#include "geometry/shapes/shape.h"
#include "geometry/solids/surface_move.h"
#include "sim/linear/precision.h"
#include "sim/model/air_inputs.h"
#include "sim/model/budget_cuts.h"
#include "sim/model/seams.h"
#include "sim/model/start_matrix.h"

namespace supple {

// Describes an obstacle, in its own frame.
struct Collider {
  std::string name;
  Shape shape;           // of a collider that deforms: its shape where the step ends
  double thickness = 0;  // of the layer around the collider that already pushes [m]
  double friction = 0;   // coefficient of Coulomb's law
};

// Holds the poses of a collider, from its frame to the world, at the start and at the end of a step, and how its
// surface deforms between them.
struct ColliderMotion {
  Eigen::Isometry3d start = no_motion();
  Eigen::Isometry3d end = no_motion();
  std::shared_ptr<const SurfaceMove> surface = nullptr;  // null: the collider is rigid

  bool deforms() const { return surface != nullptr && surface->moves(); }
  bool moves() const { return deforms() || start.matrix() != end.matrix(); }
};

// Selects how search directions take contacts, which A does not contain, into account.
enum class ContactDirection {
  diagonal,  // each stiff direction of a contact by itself
  low_rank,  // (A + contacts)^-1 by the Woodbury identity
};
template <>
struct Names<ContactDirection> {
  static constexpr std::array table = {Name{ContactDirection::diagonal, "diagonal"},
                                       Name{ContactDirection::low_rank, "low-rank"}};
};

// Selects the points of a body's surface that touch colliders.
enum class ContactPoints {
  vertices,
  surface,  // also points of edges and faces, where a collider is finer than the surface (contact/face_points.h)
};
template <>
struct Names<ContactPoints> {
  static constexpr std::array table = {Name{ContactPoints::vertices, "vertices"},
                                       Name{ContactPoints::surface, "surface"}};
};

struct ContactSettings {
  double stiffness = 1e4;  // k_c over m_i / h^2
  double push_out = 1;     // fastest way out of an overlap [body sizes / s]
  double stick = 1.5e-4;   // friction is whole above this speed [body sizes / s]
  ContactPoints points = ContactPoints::vertices;
  ContactDirection direction = ContactDirection::low_rank;
};

enum class LineSearch { armijo, none };
template <>
struct Names<LineSearch> {
  static constexpr std::array table = {Name{LineSearch::armijo, "armijo"}, Name{LineSearch::none, "none"}};
};

// Holds the settings of Chebyshev's semi-iterative acceleration (Wang 2015). docs/bench.md tells how the defaults were
// found.
struct ChebyshevSettings {
  int delay = 1;         // S: how many iterations at the start are not accelerated
  double radius = 0.85;  // rho: the spectral radius that is assumed of the plain iteration
};

// Holds the settings of [solver] that step() reads from its inputs; the others are in the Model or in the SearchRule.
struct SolverSettings {
  int iterations = 10;
  int history = 5;                           // window m of L-BFGS; 0 is plain quasi-Newton
  int levels = 2;                            // 2: where A keeps the body from turning, directions know how it turns
                                             // (coarse/second_level.h); 1: the paper's matrix alone
  StartMatrix matrix = StartMatrix::system;  // of quasi-Newton directions: one of quasi_newton_matrices
  LineSearch line_search = LineSearch::armijo;
  double armijo = 0.3;      // gamma
  double target_error = 0;  // stop when the estimates of both errors are below this; 0: no target
  double still = 0;         // stop when less than this is left to go [body sizes]; 0, or levels = 1: do all iterations
  // Single: elements may be evaluated in single precision while that is enough (solver/element_precision.h).
  Precision elements = Precision::single_precision;
  double budget_ms = 0;  // of one step: an iteration that would probably end later does not begin; 0: no bound
  int rounds = 5;        // most rounds of `iterations` in a step that goes on (solver/further_iterations.h); 1: it ends
  bool newton = true;    // Newton's method may finish hard steps (solver/newton_finish.h)
  ContactSettings contact;
  ChebyshevSettings chebyshev;
};

// Says that points of one part of a model may touch the surface of another, or that a part may touch itself
// (contact/surface_contacts.h). A world gives two of these for two parts that meet, one for the points of either.
struct Meeting {
  std::int32_t points = 0, surface = 0;  // numbers of two parts, or twice that of one that touches itself
  double friction = 0;                   // coefficient of Coulomb's law between the two

  bool is_own() const { return points == surface; }
};

// Holds all that comes from outside for one step of one body, or of several that are joined in a model.
struct StepInputs {
  Vec3 gravity = Vec3(0, -9.81, 0);  // [m/s^2]
  Positions targets;                 // at the end of the step, by Model::handled [m]
  Positions middle_targets;          // at its middle; only for implicit midpoint [m]
  SolverSettings solver;
  const std::vector<Collider>* colliders = nullptr;   // null or empty: there are none, and nothing is paid for them
  std::vector<ColliderMotion> collider_motions = {};  // motion of each collider over the step
  // Which parts of the model may touch each other or themselves, ordered by surface; empty: none, and nothing is paid
  // for it.
  std::vector<Meeting> meetings = {};
  std::optional<BudgetCuts> repeated_cuts = {};  // cuts of an earlier run, in place of the clock, for the same bits
  Wind wind = {};
  std::vector<SeamOpening> seams = {};  // by part; empty: seams are as open as at the start
  std::vector<PartAir> air = {};  // by part; empty: air acts on none and none holds gas, and nothing is paid for it
};

// Tells whether a budget of time may end the step's searches: its own, or that of an earlier run whose cuts it repeats.
inline bool has_time_budget(const StepInputs& inputs) {
  return inputs.solver.budget_ms > 0 || inputs.repeated_cuts.has_value();
}

inline std::size_t collider_count(const StepInputs& inputs) {
  return inputs.colliders == nullptr ? 0 : inputs.colliders->size();
}
inline bool has_colliders(const StepInputs& inputs) { return collider_count(inputs) > 0; }

// Tells whether contacts are looked for in a step.
inline bool may_touch(const StepInputs& inputs) { return has_colliders(inputs) || !inputs.meetings.empty(); }

}  // namespace supple
