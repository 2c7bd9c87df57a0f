#include "world/moving_body.h"

#include <cmath>
#include <limits>
#include <utility>

#include "base/error.h"
#include "base/timing.h"
#include "base/trace.h"
#include "scene/definition/air_of_body.h"
#include "scene/replay/live_keys.h"
#include "sim/measures/measures.h"
#include "sim/model/flow_step.h"
#include "sim/model/model_values.h"
#include "sim/solver/calming.h"
#include "sim/solver/step.h"

namespace supple {

MovingBody::MovingBody(const SceneDef& scene, Body& body, Model& model, const CollisionSet& set, const Solvers& solvers,
                       Threads* threads)
    : scene_(scene),
      body_(body),
      model_(model),
      set_(set),
      solvers_(solvers),
      state_(start_state(model, body)),
      workspace_(threads) {
  inputs_.colliders = &set.colliders;
  if (!body.from) state_.time = state_.flow.until = scene.time_at_start();
  apply({.factor = hold_as_state_says(), .rule = true});
  show_flow(state_.flow, model_);
}

MovingBody::~MovingBody() = default;
MovingBody::MovingBody(MovingBody&&) noexcept = default;

void MovingBody::apply(const ChangeCost& cost) {
  inputs_.gravity = scene_.gravity;
  inputs_.wind = scene_.wind.value_or(Wind{});
  inputs_.air.clear();
  if (const std::optional<PartAir> air = air_of(scene_, body_.def)) inputs_.air.push_back(*air);
  inputs_.solver = solvers_.settings(body_.def.solver.method, body_.def.solver.settings);
  model_.plastic = body_.description.plastic;
  model_.creep = body_.description.creep;
  if (cost.factor) renew_model();
  if (cost.rule || cost.factor) rule_ = solvers_.rule(body_.def.solver.method, model_);
}

void MovingBody::renew_model() {
  if (!values_) values_ = std::make_unique<ModelValues>(model_, body_.description);
  values_->set(model_, body_.description);
  show_flow(state_.flow, model_);
}

void MovingBody::restore(const State& state) {
  SUPPLE_CHECK(state.anchors.holds.size(), ==, body_.def.handles.size());
  SUPPLE_CHECK(state.flow.plastic.size(), ==, state_.flow.plastic.size());
  SUPPLE_CHECK(state.flow.viscous.size(), ==, state_.flow.viscous.size());
  state_ = state;
  if (hold_as_state_says()) apply({.factor = true});
  show_flow(state_.flow, model_);
}

bool MovingBody::hold_as_state_says() {
  bool changed = false;
  for (std::size_t h = 0; h < body_.description.handles.size(); ++h) {
    const bool holds = state_.anchors.holds[h] != 0;
    changed |= body_.description.handles[h].holds != holds;
    body_.description.handles[h].holds = holds;
  }
  return changed;
}

void MovingBody::add_handle() {
  Handle& handle = body_.description.handles.back();
  const auto number = static_cast<std::int32_t>(body_.description.handles.size()) - 1;
  handle.holds = false;
  const auto had = static_cast<Eigen::Index>(model_.handled.size());
  for (const std::int32_t v : handle.vertices) model_.handled.push_back({model_.internal_of[v], number, false});
  state_.anchors.points.conservativeResize(std::ssize(model_.handled), 3);
  for (Eigen::Index i = had; i < std::ssize(model_.handled); ++i)
    state_.anchors.points.row(i) = model_.rest.row(model_.handled[std::size_t(i)].vertex);
  state_.anchors.centers.push_back(body_.motions.back().center);
  state_.anchors.holds.push_back(0);
}

void MovingBody::keep_handles(std::size_t count) {
  body_.def.handles.resize(count);
  body_.description.handles.resize(count);
  body_.motions.resize(count);
  std::erase_if(model_.handled, [&](const Model::HandleVertex& one) { return one.handle >= std::int32_t(count); });
  state_.anchors.points.conservativeResize(std::ssize(model_.handled), 3);
  state_.anchors.centers.resize(count);
  state_.anchors.holds.resize(count);
  renew_model();
}

void MovingBody::switch_handles(double time) {
  for (std::size_t h = 0; h < body_.def.handles.size(); ++h) {
    const HandleDef& def = body_.def.handles[h];
    if (!def.grabs) continue;
    char& holds = state_.anchors.holds[h];
    const bool starts_held = time <= 0 && holds != 0;
    const bool switches = (holds != 0) != def.holds_at(time);
    if (switches) holds = holds == 0;
    if (starts_held || (switches && holds != 0)) grab(model_, static_cast<int>(h), state_.x, state_.anchors);
  }
  if (hold_as_state_says()) apply({.factor = true});
}

void MovingBody::prepare_step(int frame, int substep) {
  const Zone zone("inputs", body_.def.name);
  const double done = static_cast<double>(frame) * scene_.substeps + substep, share = 1.0 / scene_.substeps;
  span_ = {done * scene_.time_step(), (done + 1) * scene_.time_step(), substep * share, (substep + 1) * share};
  const StepSpan& span = span_;
  switch_handles(span.from);
  const Stopwatch watch;
  let_flow(model_, state_, workspace_.open().threads, lost_to_flow_);
  if (model_.flows()) flow_ms_ += watch.elapsed_ms();
  targets_at(span.to, span.change_to, inputs_.targets);
  if (model_.scheme.theta < 1)
    targets_at(0.5 * (span.from + span.to), 0.5 * (span.change_from + span.change_to), inputs_.middle_targets);
  inputs_.seams = seams_between(span.from, span.to);
  collider_motions(set_, span, inputs_.collider_motions);
}

Positions MovingBody::targets_at_start() const {
  Positions targets;
  targets_at(span_.from, span_.change_from, targets);
  return targets;
}

std::vector<SeamOpening> MovingBody::seams_at_start() const { return seams_between(span_.from, span_.from); }

std::vector<SeamOpening> MovingBody::seams_between(double from, double to) const {
  if (model_.seams.empty()) return {};
  const double seam_time = body_.def.cloth->seam_time;
  const double before = seam_opening(from, seam_time), after = seam_opening(to, seam_time);
  return {{after, 0.5 * (before + after)}};
}

void MovingBody::targets_at(double time, double change, Positions& targets) const {
  handle_targets(model_, body_, state_.anchors, time, change, targets);
  if (put_attached_) put_attached_(time, targets);
}

void MovingBody::repeat(const std::optional<BudgetCuts>& cuts) {
  inputs_.repeated_cuts = cuts;
  inputs_.solver.budget_ms = 0;
}

void MovingBody::keep_to_clock() {
  inputs_.repeated_cuts.reset();
  inputs_.solver = solvers_.settings(body_.def.solver.method, body_.def.solver.settings);
}

// Returns the model of the same body with materials whose k (equation 11) is the same and that have no minimum but
// rest.
const Model& MovingBody::rigid_model() {
  if (rigid_for_ == model_.id) {
    show_flow(state_.flow, *rigid_);
    return *rigid_;
  }
  BodyDescription description = body_.description;
  for (Material& material : description.materials)
    material = AsRigidAsPossible{0.5 * system_stiffness(material, description.fit).k};
  rigid_.emplace(build_model(description));
  show_flow(state_.flow, *rigid_);
  rigid_for_ = model_.id;
  return *rigid_;
}

const Model& MovingBody::model_of_step() {
  untangled_ = body_.def.solver.untangle && is_tangled(model_, state_.x);
  return untangled_ ? rigid_model() : model_;
}

void MovingBody::take_step(const Positions& x, Positions v, double time, std::vector<Contact> contacts,
                           StepReport report) {
  is_in_island_ = true;
  OpenWorkspace& w = workspace_.open();
  w.prepare(model_, inputs_.solver);
  w.current.x = x;
  w.current.contacts = std::move(contacts);
  w.current.elastic = std::numeric_limits<double>::quiet_NaN();
  w.report = std::move(report);
  add_time(std::exchange(flow_ms_, 0.0));
  if (w.report.failed) return;
  state_.x = x;
  state_.v = std::move(v);
  state_.time = time;
  state_.memory = {};
  calm_down();
}

// Lets the movement within the body die down at the rate that the scene asks for.
void MovingBody::calm_down() {
  const double rate = body_.def.solver.calming;
  if (rate > 0) calm(model_, std::exp(-rate * model_.time_step), state_.x, state_.v);
}

void MovingBody::add_time(double ms) {
  StepReport& report = workspace_.open().report;
  report.step_ms += ms;
  report.other_ms += ms;
}

const StepReport& MovingBody::step_untangled() {
  StepInputs inputs = inputs_;
  inputs.solver.matrix = StartMatrix::system;
  return supple::step(rigid_model(), inputs, state_, workspace_);
}

const StepReport& MovingBody::step() {
  is_in_island_ = false;
  untangled_ = body_.def.solver.untangle && is_tangled(model_, state_.x);
  const StepReport& report =
      untangled_ ? step_untangled() : supple::step(model_, inputs_, state_, workspace_.open(), *rule_);
  add_time(std::exchange(flow_ms_, 0.0));
  if (!report.failed) calm_down();
  return report;
}

}  // namespace supple
