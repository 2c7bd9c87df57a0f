#include "sim/solver/leave_prediction.h"

#include <Eigen/Geometry>
#include <utility>

#include "base/stretches.h"
#include "sim/solver/place_iterate.h"

namespace supple {
namespace {

// Holds the rigid motion over a step of the vertices that hard handles hold: q moves to `to` + turn * (q - from).
struct HandleMotion {
  Vec3 from, to;
  Eigen::AngleAxisd turn;
};

// Returns the part that hard handles hold; null where they hold none or several.
const Part* held_part(const Model& model) {
  const Part* held = nullptr;
  for (const Part& part : model.parts) {
    if (part.held == 0) continue;
    if (held != nullptr) return nullptr;
    held = &part;
  }
  return held;
}

// Fits a rigid motion to the held vertices, which belong to one part. Vertices in a line leave the turn about it open;
// a first iterate that is made by a wrong turn is not taken.
HandleMotion motion_of_handles(const Model& model, const State& state, const OpenWorkspace& w) {
  const int held = model.vertices - model.free;
  const auto before = state.x.bottomRows(held), after = w.current.x.bottomRows(held);
  const Eigen::RowVector3d from = before.colwise().mean(), to = after.colwise().mean();
  const Mat3 moments = (after.rowwise() - to).transpose() * (before.rowwise() - from);
  return {from.transpose(), to.transpose(), Eigen::AngleAxisd(nearest_rotation(moments))};
}

// Tells whether the turning of some part matters beside its own motion.
bool turns_much(const StepContext& c) {
  constexpr double little = 1e-5;  // of the kinetic energy of the part's free motion
  const Model& model = c.model;
  for (std::size_t p = 0; p < model.parts.size(); ++p) {
    const Part& part = model.parts[p];
    double way = 0;
    for (int v = part.first_free; v < part.first_free + part.free; ++v)
      way += model.mass[v] * (c.w.y.row(v) - c.state.x.row(v)).squaredNorm();
    const double energy = little * way / (2 * model.time_step * model.time_step);
    if (c.w.turning.energy_of(p) > energy) return true;
  }
  return false;
}

// Finds how turning parts depart from the straight motions h v, which stretch them, and whether that matters.
void find_turning(StepContext& c) {
  const Model& model = c.model;
  OpenWorkspace& w = c.w;
  w.turns = false;
  if (c.inputs.solver.levels < 2) return;
  const TimedPhase timed(w.clock, Phase::matrix, "turn");
  w.second_level.prepare(model);
  w.motion = model.time_step * c.state.v;
  w.turning.take_velocity(w.second_level.system(), c.state.x, w.motion);
  w.turns = turns_much(c);
  if (w.turns) w.turning.correct(model, w.second_level.system(), c.state.x, w.solve_scratch, w.turned);
}

// Sets the direction that leads from y to where the handles' departure from y is spread. Returns false where they do
// not depart.
bool spread_handles(OpenWorkspace& w) {
  Positions& right = w.scratch;
  right.setZero();
  for (const System::Coupling& entry : w.system->couplings) {
    right.row(entry.free) -= entry.value * (w.current.x.row(entry.held) - w.y.row(entry.held));
  }
  if (right.isZero(0)) return false;
  const TimedPhase timed(w.clock, Phase::solve, "solve");
  w.system->factor.solve(right.data(), w.direction.data(), w.solve_scratch);
  return true;
}

}  // namespace

bool leaves_prediction(StepContext& c) {
  find_turning(c);
  c.spreads_handles = spread_handles(c.w);
  return c.spreads_handles || c.w.turns;
}

void fit_handles_and_turning(StepContext& c) {
  OpenWorkspace& w = c.w;
  if (!c.spreads_handles) w.direction.setZero();
  if (w.turns) w.direction += w.turned;
  const TimedPhase timed(w.clock, Phase::evaluate, "leave prediction");
  find_contacts_of(c.model, c.inputs, w, w.current);
  evaluate(c.model, w, w.current, Wanted::value);
  c.at_prediction = w.current.g;
  set_trial(c.model, w, 1);
  std::swap(w.current, w.trial);
  evaluate_start(c.model, c.inputs, w);
}

bool handles_turn_far(const StepContext& c) {
  constexpr double least_turn = 0.3;  // [rad]; elements that straight ways of smaller turns deform recover soon
  if (!c.spreads_handles || held_part(c.model) == nullptr) return false;
  return !(motion_of_handles(c.model, c.state, c.w).turn.angle() < least_turn);
}

void turn_with_handles(StepContext& c) {
  const Model& model = c.model;
  OpenWorkspace& w = c.w;
  const Part& part = *held_part(model);
  const HandleMotion motion = motion_of_handles(model, c.state, w);
  TimedPhase timed(w.clock, Phase::solve, "solve");
  Positions& shares = w.scratch;
  shares.setZero();
  for (const Model::Coupling& entry : model.couplings) shares(entry.free, 0) -= entry.value;
  model.factor.solve(shares.data(), w.direction.data(), w.solve_scratch);
  shares = w.direction;
  timed.next(Phase::evaluate, "turn with handles");
  for (const bool wholly : {false, true}) {
    w.trial.x.topRows(model.free) = w.current.x.topRows(model.free);
    for (int v = part.first_free; v < part.first_free + part.free; ++v) {
      const double share = wholly ? 1 : shares(v, 0);
      const Vec3 q = c.state.x.row(v), free_way = w.y.row(v) - c.state.x.row(v);
      w.trial.x.row(v) = (Eigen::AngleAxisd(share * motion.turn.angle(), motion.turn.axis()) * (q - motion.from) +
                          motion.from + share * (motion.to - motion.from) + (1 - share) * free_way)
                             .transpose();
    }
    find_contacts_of(model, c.inputs, w, w.trial);
    evaluate(model, w, w.trial, Wanted::gradient);
    if (!(w.trial.g < w.current.g)) continue;
    std::swap(w.current, w.trial);
    w.report.objective.back() = w.current.g;
    forget_counts(w.contact);
    if (may_touch(c.inputs)) count_contacts(w.trial.contacts, w.current.contacts, w.contact);
  }
}

bool is_worse_than_prediction(const StepContext& c) { return c.at_prediction && !(c.w.current.g <= *c.at_prediction); }

void return_to_prediction(StepContext& c) {
  c.w.current.x.topRows(c.model.free) = c.w.y.topRows(c.model.free);
  c.at_prediction.reset();
  forget_start(c.w);
}

}  // namespace supple
