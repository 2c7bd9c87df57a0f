// g(x) of equation 3, or of another integrator or with damping, at trial points: value differences without
// cancellation, gradients, in a fixed order of summation. Not here: where to look next (lbfgs.h, step.h).
#pragma once

#include "base/threads.h"
#include "base/timing.h"
#include "sim/contact/contact.h"
#include "sim/contact/contact_direction.h"
#include "sim/model/inputs.h"
#include "sim/model/report.h"
#include "sim/model/state.h"

namespace supple {

// Scratch of a step; never changes a result. One for each thread that steps.
struct Workspace {
  // Makes room for a model and a window; does nothing when there is enough.
  void prepare(const Model& model, const SolverSettings& solver);

  Threads* threads = nullptr;  // may be null: one thread

  Positions y;                         // inertial prediction, n x 3 [m]
  const Positions* start = nullptr;    // where the step starts, the caller's, n x 3 [m]
  Positions q;                         // a copy of it, n x 3 [m]; empty unless the model needs it
  Positions middle;                    // where forces are evaluated, n x 3 [m]; empty unless that is not the iterate
  Positions target;                    // of soft handles, by free vertex, n_free x 3 [m]; empty when there are none
  Positions x, trial;                  // current and trial iterates, n x 3 [m]
  Positions gradient, trial_gradient;  // n_free x 3 [N]
  Positions direction;                 // n_free x 3 [m]
  AlignedVector<double> energy, trial_energy;  // by lane [J]
  AlignedVector<double> force;                 // by slot, x 3 [N]
  AlignedVector<double> local;                 // positions by thread chunk, x 3
  AlignedVector<double> solve_scratch;
  std::vector<double> partial;                        // of chunked sums
  std::vector<Positions> step_pairs, gradient_pairs;  // s and t of L-BFGS, a ring
  std::vector<double> products;                       // s_i . t_j, window x window
  ContactWork contact;
  ContactCorrection correction;
  StepReport report;
  Stopwatch since_entry;  // of the step

 private:
  std::uint64_t prepared_for_ = 0;  // Model::id
  int window_ = -1;
};

static_assert(scheme_of(Integrator::backward_euler).energy * scheme_of(Integrator::backward_euler).theta == 1 &&
              scheme_of(Integrator::implicit_midpoint).energy * scheme_of(Integrator::implicit_midpoint).theta == 1);

// Whether g depends on where the step starts other than through y.
bool needs_start(const Model& model);

// A point's place against another one.
struct Change {
  double value;  // g(point) - g(reference), or g(point) when there is no reference [J]
  double slope;  // tr(grad(point)^T direction) where a gradient was asked for [J]
};

// Evaluates g at `point` (n x 3). With a reference (point and its energies by lane) the result is the difference,
// summed element by element and vertex by vertex. Writes energies by lane, and the gradient when wanted.
Change evaluate(const Model& model, Workspace& workspace, const Positions& point, AlignedVector<double>& energy,
                Positions* gradient, const Positions* reference, const AlignedVector<double>* reference_energy);

// The round-off of differences of g at a point with this objective and largest coordinate [J].
double noise_of(const Model& model, double objective, double extent);

// E(x) of all elements [J]. Overwrites the workspace's trial energies.
double elastic_energy(const Model& model, Workspace& workspace, const Positions& x);

// Runs chunks on the workspace's threads when there is enough work to be worth waking them.
template <class Body>
void run_chunks(Workspace& workspace, int chunks, long work, const Body& body) {
  constexpr long worth_sharing = 40000;  // of the order of 20 microseconds; below, waking a thread costs as much
  if (workspace.threads != nullptr && work > worth_sharing) {
    workspace.threads->run(chunks, body);
  } else {
    for (int chunk = 0; chunk < chunks; ++chunk) body(chunk);
  }
}

constexpr int vertices_a_chunk = 1024;  // of vertex-wise sums; fixed, so that sums do not depend on threads

inline int vertex_chunks(const Model& model) { return (model.free + vertices_a_chunk - 1) / vertices_a_chunk; }

}  // namespace supple
