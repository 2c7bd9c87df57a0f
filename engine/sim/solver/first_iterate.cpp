#include "sim/solver/first_iterate.h"

#include <Eigen/SVD>
#include <algorithm>
#include <optional>
#include <utility>

#include "base/error.h"
#include "sim/contact/usual_depth.h"
#include "sim/solver/first_forces.h"

namespace supple {

void find_contacts_of(const Model& model, const StepInputs& inputs, Workspace& w, Iterate& iterate) {
  if (!has_colliders(inputs)) return;
  const TimedPhase timed(w.clock, Phase::collide, "find contacts");
  find_contacts(model, inputs, iterate.x, w.threads, w.contact, iterate.contacts);
}

void set_trial(const Model& model, Workspace& w, double alpha) {
  w.trial.x.topRows(model.free) = w.current.x.topRows(model.free) + alpha * w.direction;
  if (w.is_bowed) w.trial.x.topRows(model.free) += alpha * alpha * w.bow;
}

void move_rigidly(const Model& model, const Eigen::Isometry3d& motion, Positions& x) {
  for (int v = 0; v < model.free; ++v) x.row(v) = (motion * Vec3(x.row(v))).transpose();
}

void inertial_prediction(const Model& model, const StepInputs& inputs, const State& state, Positions& y) {
  const double h = model.time_step;
  y = (state.x + h * state.v).rowwise() + (model.scheme.force * h * h * inputs.gravity).transpose();
}

namespace {

// Held vertices are at their targets in both iterates; soft handles pull towards theirs.
void set_targets(const Model& model, const StepInputs& inputs, Workspace& w) {
  const bool midway = model.scheme.theta < 1;
  SUPPLE_CHECK(inputs.targets.rows(), ==, Eigen::Index(model.handled.size()));
  if (midway && !model.handle_stiffness.empty())
    SUPPLE_CHECK(inputs.middle_targets.rows(), ==, Eigen::Index(model.handled.size()));
  for (std::size_t i = 0; i < model.handled.size(); ++i) {
    const std::int32_t v = model.handled[i].vertex;
    if (v < model.free) {
      w.target.row(v) = midway ? inputs.middle_targets.row(i) : inputs.targets.row(i);
    } else {
      w.current.x.row(v) = inputs.targets.row(i);
    }
  }
  const int held = model.vertices - model.free;
  if (held > 0) w.trial.x.bottomRows(held) = w.current.x.bottomRows(held);
}

}  // namespace

void begin_step(const Model& model, const StepInputs& inputs, const State& state, Workspace& w) {
  SUPPLE_CHECK(state.x.rows(), ==, model.vertices);
  SUPPLE_CHECK(state.v.rows(), ==, model.vertices);
  inertial_prediction(model, inputs, state, w.y);
  w.start_positions = &state.x;
  w.system = w.correction.matrix = &model;
  w.correction.threads = w.threads;
  w.hessian_serves = w.second_level_serves = false;
  w.correction.second = nullptr;
  w.is_bowed = false;
  if (needs_start(model)) w.start_copy = state.x;
  w.current.contacts.clear();
  w.trial.contacts.clear();
  if (has_colliders(inputs)) {
    const TimedPhase timed(w.clock, Phase::collide, "begin contacts");
    begin_contacts(model, inputs, state.x, w.y, w.threads, w.contact);
    begin_corrections(model, w.correction);
  }
  if (has_colliders(inputs)) find_first_forces(model, inputs, state, w);
  w.current.x = w.y;
  set_targets(model, inputs, w);
}

void evaluate_start(const Model& model, const StepInputs& inputs, Workspace& w) {
  const TimedPhase timed(w.clock, Phase::evaluate, "evaluate start");
  if (has_colliders(inputs)) {
    w.trial.contacts.swap(w.current.contacts);
    find_contacts_of(model, inputs, w, w.current);
    count_contacts(w.trial.contacts, w.current.contacts, w.contact);
  }
  evaluate(model, w, w.current, Wanted::gradient);
  w.report.objective.push_back(w.current.g);
}

namespace {

// Drops a first iterate that was tried, because the step does not start from it.
void forget_start(Workspace& w) {
  w.report.objective.clear();
  forget_counts(w.contact);
}

// The rigid motion of what hard handles hold, over a step: from rotation * (q - from) to a place relative to `to`.
struct HandleMotion {
  Vec3 from, to;
  Eigen::AngleAxisd turn;
};

// Fits a rigid motion to the held vertices (Kabsch 1976, "A solution for the best rotation to relate two sets of
// vectors").
HandleMotion motion_of_handles(const Model& model, const State& state, const Workspace& w) {
  const int held = model.vertices - model.free;
  const auto before = state.x.bottomRows(held), after = w.current.x.bottomRows(held);
  const Eigen::RowVector3d from = before.colwise().mean(), to = after.colwise().mean();
  const Mat3 moments = (after.rowwise() - to).transpose() * (before.rowwise() - from);
  const Eigen::JacobiSVD<Mat3> svd(moments, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Mat3 u = svd.matrixU();
  if ((u * svd.matrixV().transpose()).determinant() < 0) u.col(2) *= -1;
  return {from.transpose(), to.transpose(), Eigen::AngleAxisd(Mat3(u * svd.matrixV().transpose()))};
}

// Tries first iterates in which the body turns with its handles. Where they turn far in a step, straight ways to their
// targets lead through each other: the body would start torn and inside out. How much a vertex follows is its share in
// the solution of A_ff s = -A_fh 1, by the model that spreads the handles' ways; or else it follows wholly, as a stiff
// body does. The current iterate stays where it is the better one.
void turn_with_handles(const Model& model, const StepInputs& inputs, const State& state, Workspace& w) {
  constexpr double least_turn = 0.3;  // [rad]; below, what straight ways do to the elements is soon undone
  const HandleMotion motion = motion_of_handles(model, state, w);
  if (motion.turn.angle() < least_turn) return;
  TimedPhase timed(w.clock, Phase::solve, "solve");
  Positions& shares = w.scratch;
  shares.setZero();
  for (const Model::Coupling& entry : model.couplings) shares(entry.free, 0) -= entry.value;
  model.factor.solve(shares.data(), w.direction.data(), w.solve_scratch.data());
  shares = w.direction;
  timed.next(Phase::evaluate, "turn with handles");
  for (const bool wholly : {false, true}) {
    for (int v = 0; v < model.free; ++v) {
      const double share = wholly ? 1 : shares(v, 0);
      const Vec3 q = state.x.row(v), free_way = w.y.row(v) - state.x.row(v);
      w.trial.x.row(v) = (Eigen::AngleAxisd(share * motion.turn.angle(), motion.turn.axis()) * (q - motion.from) +
                          motion.from + share * (motion.to - motion.from) + (1 - share) * free_way)
                             .transpose();
    }
    find_contacts_of(model, inputs, w, w.trial);
    evaluate(model, w, w.trial, Wanted::gradient);
    if (!(w.trial.g < w.current.g)) continue;
    std::swap(w.current, w.trial);
    w.report.objective.back() = w.current.g;
    forget_counts(w.contact);
    if (has_colliders(inputs)) count_contacts(w.trial.contacts, w.current.contacts, w.contact);
  }
}

// Finds how what turns departs from the straight motions h v, and whether that matters: straight motions stretch it.
void find_turning(const Model& model, const StepInputs& inputs, const State& state, Workspace& w) {
  constexpr double little = 1e-5;  // of the kinetic energy of what the body would do freely
  w.turns = false;
  if (inputs.solver.levels < 2) return;
  const TimedPhase timed(w.clock, Phase::matrix, "turn");
  w.second_level.prepare(model);
  double way = 0;
  for (int v = 0; v < model.free; ++v) way += model.mass[v] * (w.y.row(v) - state.x.row(v)).squaredNorm();
  const double energy = little * way / (2 * model.time_step * model.time_step);
  w.motion = model.time_step * state.v;
  w.turning.take_velocity(w.second_level.system(), state.x, w.motion);
  w.turns = w.turning.energy() > energy;
  if (w.turns) w.turning.correct(model, w.second_level.system(), state.x, w.solve_scratch, w.turned);
}

// Sets the direction to that from y which spreads the handles' departure from y. Returns false where they do not
// depart.
bool spread_handles(Workspace& w) {
  Positions& right = w.scratch;
  right.setZero();
  for (const System::Coupling& entry : w.system->couplings) {
    right.row(entry.free) -= entry.value * (w.current.x.row(entry.held) - w.y.row(entry.held));
  }
  if (right.isZero(0)) return false;
  const TimedPhase timed(w.clock, Phase::solve, "solve");
  w.system->factor.solve(right.data(), w.direction.data(), w.solve_scratch.data());
  return true;
}

// Sets a first iterate that fits the handles and turns what turns. The paper starts from y. With rows eliminated, y
// tears the elements beside a handle apart by all that the handle did not do freely (its keyed motion, and the fall
// that it did not take), often by more than their size. The handles' departure from y is therefore spread into the body
// by the quadratic model that also gives the directions, A_ff d_f = -A_fh d_h: one solve. What starting from y cost in
// earlier films is in docs/lab/2026-11-22-films-of-the-paper.md ("Error of the polynomial head"). Where parts turn
// fast, y stretches them, and the start has them turned instead (coarse/turning.h). This costs one additional
// evaluation, because y stays the first iterate where it is the better one. Returns g(y), with the handles at their
// targets, when the first iterate is another one.
std::optional<double> leave_prediction(const Model& model, const StepInputs& inputs, const State& state, Workspace& w) {
  find_turning(model, inputs, state, w);
  const bool spreads = spread_handles(w);
  if (!spreads && !w.turns) return std::nullopt;
  if (!spreads) w.direction.setZero();
  if (w.turns) w.direction += w.turned;
  const TimedPhase timed(w.clock, Phase::evaluate, "leave prediction");
  find_contacts_of(model, inputs, w, w.current);
  evaluate(model, w, w.current, Wanted::value);
  const double at_y = w.current.g;
  set_trial(model, w, 1);
  std::swap(w.current, w.trial);
  evaluate_start(model, inputs, w);
  if (spreads) turn_with_handles(model, inputs, state, w);
  if (w.current.g <= at_y) return at_y;
  w.current.x.topRows(model.free) = w.y.topRows(model.free);
  forget_start(w);
  return std::nullopt;
}

// A first iterate far below a surface would start from torn or inverted elements, or beyond the collider. So the body
// goes only as far as the first impact and a little further. If the collider moves, the body then goes on with it: at
// the end of the step, it lies before the collider as it would if the same impact were seen from the collider. That
// is not better for a body that is held, or that is carried into another collider; there, the lower objective decides.
// Returns whether it was stopped.
bool stop_at_impact(const Model& model, const StepInputs& inputs, const State& state, Workspace& w) {
  if (!has_colliders(inputs)) return false;
  const TimedPhase timed(w.clock, Phase::collide, "stop at impact");
  Positions& x = w.current.x;
  const Impact impact = first_impact(model, inputs, x, usual_depth(model.size), w.contact);
  if (impact.collider < 0) return false;
  x.topRows(model.free) = state.x.topRows(model.free) + impact.share * (x - state.x).topRows(model.free);
  if (!inputs.collider_motions[impact.collider].moves()) return true;
  find_contacts_of(model, inputs, w, w.current);
  evaluate(model, w, w.current, Wanted::value);
  w.trial.x.topRows(model.free) = x.topRows(model.free);
  move_rigidly(model, motion_after(inputs, impact.collider, impact.share), w.trial.x);
  find_contacts_of(model, inputs, w, w.trial);
  evaluate(model, w, w.trial, Wanted::value);
  if (w.trial.g < w.current.g) std::swap(w.current, w.trial);
  return true;
}

// Tells whether a body moves so little that what acts on it must be balanced: it hangs still, or lies.
bool is_still(const Model& model, const State& state, const Workspace& w) {
  constexpr double little = 0.01;  // of the energy of what the step would have it do freely
  double way = 0, free_way = 0;
  for (int v = 0; v < model.free; ++v) {
    way += model.mass[v] * state.v.row(v).squaredNorm();
    free_way += model.mass[v] * (w.y.row(v) - state.x.row(v)).squaredNorm();
  }
  return model.time_step * model.time_step * way < little * free_way;
}

// Makes the trial positions the first iterate where their g is below a share of the current one's. Friction is treated
// as in descend_from_staying().
void start_from_trial_below(double share, const Model& model, const StepInputs& inputs, Workspace& w) {
  const double stick = w.contact.stick_length;
  const double given = w.current.g - friction_energy(w.current.contacts, stick, w.current.x);
  find_contacts_of(model, inputs, w, w.trial);
  const double rubbed = friction_energy(w.trial.contacts, stick, w.trial.x);
  evaluate(model, w, w.trial, Wanted::gradient);
  if (!(w.trial.g - rubbed < share * given)) return;
  std::swap(w.current, w.trial);
  w.report.objective.back() = w.current.g;
  if (!has_colliders(inputs)) return;
  forget_counts(w.contact);
  count_contacts(w.trial.contacts, w.current.contacts, w.contact);
}

// Starts from q + h v where that is better. y contains the fall of the step, which leaves a body that rests on
// something, or slides along it, g h^2 deep in its colliders, and one that hangs still that far from where it stays: a
// soft one comes no nearer in its iterations than it was, and needs as many again. This costs an evaluation, and only
// where something touches or hardly moves.
void start_without_fall(const Model& model, const StepInputs& inputs, const State& state, Workspace& w) {
  const TimedPhase timed(w.clock, Phase::evaluate, "start without fall");
  w.trial.x.topRows(model.free) = (state.x + model.time_step * state.v).topRows(model.free);
  if (w.turns) w.trial.x.topRows(model.free) += w.turned;
  start_from_trial_below(1, model, inputs, w);
}

// Starts from q where that is far better. Points between vertices that rest in something thin have no room: what the
// body would do freely leads through it. This costs an evaluation, and only where such points touch and inertia alone
// does not rule q out.
void start_where_it_was(const Model& model, const StepInputs& inputs, const State& state, Workspace& w) {
  constexpr double far_better = 0.25;
  const auto lies_between = [](const Contact& contact) { return contact.depth > 0 && !contact.point.is_vertex(); };
  if (std::ranges::none_of(w.current.contacts, lies_between)) return;
  const TimedPhase timed(w.clock, Phase::evaluate, "start where it was");
  w.trial.x.topRows(model.free) = state.x.topRows(model.free);
  if (inertial_energy(model, w, w.trial.x) < far_better * w.current.g || model.energy_may_be_negative)
    start_from_trial_below(far_better, model, inputs, w);
}

}  // namespace

double set_first_iterate(const Model& model, const StepInputs& inputs, const State& state, Workspace& w) {
  const std::optional<double> at_y = leave_prediction(model, inputs, state, w);
  const bool stopped = stop_at_impact(model, inputs, state, w);
  if (stopped) forget_start(w);
  if (stopped || !at_y) evaluate_start(model, inputs, w);
  const bool touches = has_colliders(inputs) && w.contact.counts.touching > 0;
  const double from = at_y ? *at_y : w.current.g;
  if (touches || is_still(model, state, w)) start_without_fall(model, inputs, state, w);
  if (touches) start_where_it_was(model, inputs, state, w);
  const bool known = at_y || !touches;
  return known && !stopped ? from - w.report.objective.back() : 0;
}

}  // namespace supple
