#include "sim/solver/energy_gain.h"

#include <cmath>

#include "sim/solver/objective.h"
#include "sim/solver/search_rule.h"

namespace supple {

double work_of_handles(const Model& model, const Positions& q, OpenWorkspace& w) {
  const Positions& x = w.current.x;
  if ((x.bottomRows(model.vertices - model.free) - q.bottomRows(model.vertices - model.free)).isZero(0)) return 0;
  return work_on_held(model, w, x, q);
}

namespace {

// Returns the work of the contacts' forces, friction among them, along the way of each vertex [J].
double work_of_contacts(const Positions& q, OpenWorkspace& w) {
  Positions& force = w.scratch;
  force.setZero();
  add_contacts(w.current.contacts, w.current.x, nullptr, w.direction, &force, -1);
  double work = 0;
  for (const Contact& contact : w.current.contacts) {
    for (int k = 0; k < contact.stencil.free; ++k) {
      const std::int32_t v = contact.stencil.vertex[k];
      work += force.row(v).dot(w.current.x.row(v) - q.row(v));
      force.row(v).setZero();  // a vertex may belong to several contacts
    }
  }
  return work;
}

// Returns g without its inertia, without contact and without drag [J].
double potential_of(const Model& model, const OpenWorkspace& w, const Iterate& at) {
  return at.g - inertial_energy(model, w, at.x) - contact_energy(at.contacts, at.x) -
         friction_energy(at.contacts, at.x) - w.air.drag_energy(model, at.x);
}

}  // namespace

double work_from_outside(const Model& model, const Positions& q, OpenWorkspace& w) {
  return (model.free < model.vertices ? work_of_handles(model, q, w) : 0) +
         (w.current.contacts.empty() ? 0 : work_of_contacts(q, w)) + w.air.work(model, w.current.x);
}

namespace {

// Returns the kinetic energy of a body that has fallen from rest for two steps [J]. An energy that is small beside it
// is not worth iterations: a cloth that comes to rest exchanges next to nothing in a step, and without this bound would
// make five times as many iterations.
double energy_of_short_fall(const Model& model, const StepInputs& inputs) {
  return 2 * model.total_mass * model.time_step * model.time_step * inputs.gravity.squaredNorm();
}

// Tells whether a step may have gained more than this share of the energies that it moves and of a short fall's, by a
// bound that evaluates nothing. Where E is convex between q and x, the energy from nothing is at most r . (x - q) - 1/2
// |v' - v|^2_M, where r is the remaining gradient of g at x. The current iterate must have its gradient.
bool may_gain_energy(const Model& model, const StepInputs& inputs, const State& state, const OpenWorkspace& w,
                     double share) {
  if (model.integrator != Integrator::backward_euler) return false;
  double bound = 0, kinetic = 0, fallen = 0;
  for (int v = 0; v < model.free; ++v) {
    const Vec3 way = (w.current.x.row(v) - state.x.row(v)).transpose();
    const Vec3 velocity = way / model.time_step, before = state.v.row(v).transpose();
    bound += w.current.gradient.row(v).dot(way) - 0.5 * model.mass[v] * (velocity - before).squaredNorm();
    kinetic += 0.5 * model.mass[v] * (velocity.squaredNorm() + before.squaredNorm());
    fallen += model.mass[v] * way.dot(inputs.gravity);
  }
  return bound > share * (kinetic + std::abs(fallen) + energy_of_short_fall(model, inputs));
}

// Returns the energy that the step to the current iterate gained from nothing, over those that it exchanged and that of
// a short fall; zero or less where it gained none, and for integrators other than backward Euler. Evaluates all
// elements at q.
double share_from_nothing(const Model& model, const StepInputs& inputs, const State& state, OpenWorkspace& w) {
  if (model.integrator != Integrator::backward_euler) return 0;
  double kinetic = 0, before = 0, fallen = 0;
  for (int v = 0; v < model.free; ++v) {
    const Vec3 way = (w.current.x.row(v) - state.x.row(v)).transpose();
    kinetic += 0.5 * model.mass[v] * way.squaredNorm() / (model.time_step * model.time_step);
    before += 0.5 * model.mass[v] * state.v.row(v).squaredNorm();
    fallen += model.mass[v] * way.dot(inputs.gravity);
  }
  const double after = potential_of(model, w, w.current);
  const double work = work_from_outside(model, state.x, w);
  w.trial.x = state.x;
  w.trial.contacts.clear();
  evaluate(model, w, w.trial, Wanted::value);
  const double change = after - potential_of(model, w, w.trial);
  w.trial.x.bottomRows(model.vertices - model.free) = w.current.x.bottomRows(model.vertices - model.free);
  const double gained = kinetic - before + change - fallen - work;
  return gained / (kinetic + before + std::abs(change) + std::abs(fallen) + std::abs(work) +
                   energy_of_short_fall(model, inputs));
}

}  // namespace

bool gains_energy(const StepContext& c) {
  constexpr double much = 0.01;       // share of the energies that the step exchanges
  constexpr int usual_trials = 2;     // points that an iteration tries, unless it has a hard time
  constexpr double much_left = 1e-4;  // share of the step's gain; a step that comes nearer has a small gradient
  const StepReport& report = c.w.report;
  const bool hard = report.line_search > usual_trials * report.iterations;
  const bool unsolved = -report.slope > much_left * (report.decrease + c.above_start);  // by the last direction
  const bool has_gradient = c.rule.needs_gradient() || c.inputs.solver.line_search != LineSearch::none;
  const bool may_gain = hard || (unsolved && has_gradient && may_gain_energy(c.model, c.inputs, c.state, c.w, much));
  if (!may_gain) return false;
  const TimedPhase timed(c.w.clock, Phase::evaluate, "check energy");
  return share_from_nothing(c.model, c.inputs, c.state, c.w) > much;
}

}  // namespace supple
