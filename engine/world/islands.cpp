#include "world/islands.h"

#include <algorithm>
#include <exception>
#include <functional>
#include <map>
#include <utility>

#include "base/disjoint_sets.h"
#include "base/timing.h"
#include "base/trace.h"
#include "scene/definition/meeting.h"
#include "sim/contact/own_sheet.h"
#include "sim/contact/own_surface.h"
#include "sim/contact/part_contacts.h"
#include "sim/contact/sheet_layer.h"
#include "sim/model/element_view.h"
#include "sim/model/joined_model.h"
#include "sim/solver/begin_step.h"
#include "sim/solver/search_rule.h"
#include "sim/solver/step.h"

namespace supple {
namespace {

constexpr std::size_t most_kept = 16;  // joined models that are kept for later steps

// Returns the members of each set, in the order of their first members.
std::vector<std::vector<std::size_t>> lists_of(DisjointSets& sets) {
  std::vector<std::vector<std::size_t>> by_first(sets.size()), lists;
  for (std::size_t i = 0; i < sets.size(); ++i) by_first[sets.of(i)].push_back(i);
  for (auto& list : by_first) {
    if (!list.empty()) lists.push_back(std::move(list));
  }
  return lists;
}

// Returns where a body's vertices would go if nothing touched them, with hard handles at their targets (n x 3) [m].
Positions free_motion(const Model& model, const StepInputs& inputs, const State& state) {
  Positions y;
  inertial_prediction(model, inputs, state, y);
  for (std::size_t i = 0; i < model.handled.size(); ++i) {
    if (model.handled[i].vertex >= model.free) y.row(model.handled[i].vertex) = inputs.targets.row(i);
  }
  return y;
}

}  // namespace

struct Islands::Way {
  Positions y;               // n x 3 [m]
  Bounds swept;              // of the body from q to y
  Vec3 mean = Vec3::Zero();  // its mean motion [m]
  std::uint64_t structure = 0;
  double layer = 0;  // of a sheet, or between a surface and what is drawn: contact holds others there [m]
  mutable std::unique_ptr<MovingSurface> surface;
  mutable bool is_moved = false;  // whether the surface goes the way of this step
};

struct Islands::Together {
  std::vector<std::uint64_t> members;  // ids of the bodies' models
  Model model;
  std::unique_ptr<SearchRule> rule;
  Workspace workspace;
  State state;
  StepInputs inputs;  // of the last step

  Together(const std::vector<const Model*>& models, Threads* threads) : model(join(models)), workspace(threads) {
    for (const Model* of : models) members.push_back(of->id);
  }
};

struct Islands::Own {
  std::uint64_t structure = 0;
  std::unique_ptr<OwnSurface> surface;  // of a solid
  std::unique_ptr<OwnSheet> sheet;      // of a cloth
  std::unique_ptr<MovingSurface> moving;
  bool touched = false;  // in the last step: then the next one is looked at first, which saves work alone
};

Islands::Islands(const SceneDef& scene, const std::vector<std::unique_ptr<MovingBody>>& bodies, const Solvers& solvers,
                 Threads* threads)
    : scene_(scene),
      bodies_(bodies),
      solvers_(solvers),
      threads_(threads),
      ways_(bodies.size()),
      owns_(bodies.size()),
      wasted_(bodies.size(), 0.0) {}
Islands::~Islands() = default;

void Islands::find_ways() {
  for (std::size_t b = 0; b < bodies_.size(); ++b) {
    const MovingBody& body = *bodies_[b];
    Way& way = ways_[b];
    const Positions& q = body.state().x;
    way.y = free_motion(body.model(), body.inputs(), body.state());
    way.mean = (way.y - q).colwise().mean().transpose();
    way.swept = bounds_of(q);
    const Bounds end = bounds_of(way.y);
    way.swept.include(end.lower);
    way.swept.include(end.upper);
    way.is_moved = false;
    if (way.structure == body.model().structure) continue;
    way.surface.reset();
    way.structure = body.model().structure;
    const Model& model = body.model();
    way.layer = model.parts.front().solid ? 0 : sheet_layer(mean_edge(model.surface, model.rest));
    for (const double overhang : model.overhang) way.layer = std::max(way.layer, overhang);
  }
}

MovingSurface& Islands::surface_of(std::size_t body) const {
  const Way& way = ways_[body];
  const Model& model = bodies_[body]->model();
  if (way.surface == nullptr) way.surface = std::make_unique<MovingSurface>(model.surface, model.rest);
  if (!way.is_moved) {
    way.surface->set_start(bodies_[body]->state().x);
    way.surface->set_end(way.y);
  }
  way.is_moved = true;
  return *way.surface;
}

// Tells whether two bodies may touch in the step. pushed: how far others may push them off their ways [m].
bool Islands::may_touch(std::size_t a, std::size_t b, double pushed) const {
  constexpr double near = 0.01;  // of the smaller body's size
  const Model &one = bodies_[a]->model(), &other = bodies_[b]->model();
  if (one.surface.rows() == 0 || other.surface.rows() == 0) return false;
  const double h = one.time_step;
  const double margin = near * std::min(one.size, other.size) + 0.25 * h * h * scene_.gravity.norm() + pushed +
                        ways_[a].layer + ways_[b].layer;
  for (int k = 0; k < 3; ++k) {
    if (ways_[a].swept.lower[k] - margin > ways_[b].swept.upper[k] ||
        ways_[b].swept.lower[k] - margin > ways_[a].swept.upper[k])
      return false;
  }
  // Bodies that go the same way meet where a collider stops the first of them, so all of their ways count then.
  const Vec3 carried = may_be_stopped(a) || may_be_stopped(b) ? Vec3(Vec3::Zero()) : ways_[a].mean;
  return surface_of(a).may_meet(surface_of(b), margin, carried) || is_within(a, b) || is_within(b, a);
}

// Tells whether a body begins the step wholly within another one, far from its surface.
bool Islands::is_within(std::size_t inner, std::size_t outer) const {
  const Model& model = bodies_[inner]->model();
  if (!bodies_[outer]->model().parts.front().solid) return false;
  const Bounds &own = surface_of(inner).bounds_at_start(), &other = surface_of(outer).bounds_at_start();
  if ((own.lower.array() < other.lower.array()).any() || (own.upper.array() > other.upper.array()).any()) return false;
  const Vec3 point = bodies_[inner]->state().x.row(model.surface(0, 0));
  const auto place = surface_of(outer).closest_at_start(point, bodies_[outer]->model().size);
  return place && place->distance < 0;
}

// Tells whether a body may come to a collider on its way.
bool Islands::may_be_stopped(std::size_t body) const {
  const StepInputs& inputs = bodies_[body]->inputs();
  const Vec3 center = ways_[body].swept.center();
  const double radius = 0.5 * ways_[body].swept.diagonal();
  for (std::size_t c = 0; c < collider_count(inputs); ++c) {
    const Collider& collider = (*inputs.colliders)[c];
    const ColliderMotion& motion = inputs.collider_motions[c];
    if (motion.moves()) return true;
    const double distance = collider.shape.distance(motion.start.inverse() * center);
    if (collider.shape.certainty() * distance - collider.thickness <= radius) return true;
  }
  return false;
}

std::vector<std::vector<std::size_t>> Islands::find() {
  const std::size_t count = bodies_.size();
  touches_.clear();
  saved_ms_ = 0;
  DisjointSets groups(count);
  std::vector<std::array<std::size_t, 2>> pairs;
  for (std::size_t a = 0; a < count; ++a) {
    for (std::size_t b = a + 1; b < count; ++b) {
      if (meet(scene_, a, b)) pairs.push_back({a, b});
    }
  }
  if (pairs.empty()) return lists_of(groups);
  const Zone zone("islands");
  find_ways();
  // An island may push its bodies off their ways, as far as they go beside each other, and into others.
  std::vector<double> pushed(count, 0.0);
  for (bool grows = true; grows;) {
    grows = false;
    for (const auto& [a, b] : pairs) {
      if (groups.of(a) == groups.of(b) || !may_touch(a, b, pushed[a] + pushed[b])) continue;
      groups.join(a, b);
      grows = true;
    }
    for (const std::vector<std::size_t>& island : lists_of(groups)) {
      double most = 0;
      for (const std::size_t a : island) most = std::max(most, (ways_[a].mean - ways_[island.front()].mean).norm());
      for (const std::size_t a : island) pushed[a] = most;
    }
  }
  return lists_of(groups);
}

Islands::Together& Islands::together(const std::vector<std::size_t>& island) {
  std::vector<const Model*> models;
  std::vector<std::uint64_t> members;
  for (const std::size_t b : island) {
    models.push_back(&bodies_[b]->model_of_step());
    members.push_back(models.back()->id);
  }
  const auto has_members = [&](const auto& known) { return known->members == members; };
  auto at = std::find_if(together_.begin(), together_.end(), has_members);
  if (at == together_.end()) {
    if (together_.size() >= most_kept) together_.pop_back();
    at = together_.insert(together_.end(), std::make_unique<Together>(models, threads_));
  }
  std::rotate(together_.begin(), at, at + 1);
  return *together_.front();
}

// Islands are solved by the quasi-Newton method, with the settings of their first body and as many iterations as any
// body asks for. Other methods have matrices without room for contacts between bodies.
StepInputs Islands::inputs_of(const std::vector<std::size_t>& island, const Selves& selves, const Model& joined) const {
  StepInputs inputs = bodies_[island.front()]->inputs();
  inputs.solver = solvers_.settings(Method::quasi_newton, scene_.bodies[island.front()].solver.settings);
  inputs.solver.matrix = StartMatrix::system;
  inputs.solver.budget_ms = bodies_[island.front()]->inputs().solver.budget_ms;  // none where cuts are repeated
  inputs.targets.resize(std::ssize(joined.handled), 3);
  inputs.middle_targets.resize(joined.scheme.theta < 1 ? std::ssize(joined.handled) : 0, 3);
  Eigen::Index row = 0;
  for (const std::size_t b : island) {
    const StepInputs& own = bodies_[b]->inputs();
    inputs.targets.middleRows(row, own.targets.rows()) = own.targets;
    if (joined.scheme.theta < 1) inputs.middle_targets.middleRows(row, own.targets.rows()) = own.middle_targets;
    row += own.targets.rows();
    inputs.solver.iterations = std::max(inputs.solver.iterations, own.solver.iterations);
  }
  for (std::size_t s = 0; s < island.size(); ++s) {
    for (std::size_t p = 0; p < island.size(); ++p) {
      if (p == s ? !selves[s] : !meet(scene_, island[p], island[s])) continue;
      inputs.meetings.push_back({static_cast<std::int32_t>(p), static_cast<std::int32_t>(s),
                                 pair_friction(scene_.bodies[island[p]], scene_.bodies[island[s]])});
    }
  }
  return inputs;
}

namespace {

// Returns what a step of several bodies was for one of them: times by its share of the vertices, forces and contacts of
// its own; iterations, energies and errors are those of all.
StepReport report_of_part(const Model& joined, const Part& part, const StepReport& all,
                          const std::vector<Contact>& contacts, const Positions& x) {
  StepReport report = all;
  const double share = static_cast<double>(part.free) / joined.free;
  for (double* time : {&report.step_ms, &report.evaluate_ms, &report.solve_ms, &report.lbfgs_ms, &report.collide_ms,
                       &report.matrix_ms, &report.other_ms, &report.start_ms})
    *time *= share;
  report.contacts.touching =
      static_cast<int>(std::ranges::count_if(contacts, [](const Contact& c) { return c.depth > 0; }));
  std::ranges::fill(report.collider_forces, Vec3::Zero());
  add_forces(contacts, x, report.collider_forces);
  Positions force = Positions::Zero(x.rows(), 3);
  const Positions none = Positions::Zero(x.rows(), 3);
  add_contacts(contacts, x, nullptr, none, &force, -1);
  report.contact_force = force.topRows(part.free).colwise().sum().transpose();
  return report;
}

}  // namespace

void Islands::note_touches(const std::vector<std::size_t>& island, const Model& joined, const Positions& x,
                           const std::vector<Contact>& contacts) {
  std::map<std::pair<std::size_t, std::size_t>, BodyTouch> by_pair;
  for (const Contact& contact : contacts) {
    if (contact.other.is_collider()) continue;
    const std::size_t point = island[joined.part_number(contact.number)], other = island[contact.other.part];
    const auto [a, b] = std::pair(std::min(point, other), std::max(point, other));
    const double above = gap(contact, x), inside = -(above + contact.offset);
    if (above >= 0 && inside <= 0) continue;
    BodyTouch& touch = by_pair.try_emplace({a, b}, BodyTouch{.a = a, .b = b}).first->second;
    ++touch.contacts;
    touch.depth = std::max(touch.depth, inside);
    const Vec3 on_point = -2 * contact.stiffness * std::min(0.0, above) * contact.normal;
    touch.force += point == b ? on_point : Vec3(-on_point);
  }
  for (const auto& [pair, touch] : by_pair) touches_.push_back(touch);
  std::ranges::sort(touches_, {}, [](const BodyTouch& touch) { return std::pair(touch.a, touch.b); });
}

Islands::Own& Islands::own_of(std::size_t body) {
  Own& own = owns_[body];
  const Model& model = bodies_[body]->model();
  if (own.structure == model.structure) return own;
  own.structure = model.structure;
  own.moving = std::make_unique<MovingSurface>(model.surface, model.rest);
  if (model.parts.front().solid) {
    own.surface = std::make_unique<OwnSurface>(tetrahedra_of(model), model.surface, model.rest, model.size);
  } else {
    own.sheet = std::make_unique<OwnSheet>(*own.moving, model.rest);
  }
  own.touched = false;
  return own;
}

bool Islands::begins_in_itself(std::size_t body, const Positions& q) {
  const Own& own = own_of(body);
  own.moving->set_end(q);
  own.moving->set_start(q);
  return own.sheet != nullptr ? own.sheet->overlaps(*own.moving, q) : own.surface->overlaps(*own.moving, q);
}

bool Islands::comes_through_itself(std::size_t body, const Positions& q) {
  const Zone zone("touching itself");
  const Own& own = own_of(body);
  const Positions& x = bodies_[body]->state().x;
  own.moving->set_start(q);
  own.moving->set_end(x);
  const Vec3 carried = (x - q).colwise().mean().transpose();
  return own.sheet != nullptr ? own.sheet->touches(*own.moving, q, x, carried)
                              : own.surface->touches(*own.moving, q, x, carried);
}

// Which bodies touch themselves in a step must follow from the states alone, and not from whether a body was looked at
// before its step or after it: those that begin in themselves come first, then those that come through themselves in
// the step of these. A step with a budget of time is made once, by what begins in itself alone: its cuts are repeated
// in other runs, and those of a step that is thrown away are not known there.
int Islands::step(const std::vector<std::size_t>& island) {
  std::vector<std::size_t> able;  // members
  for (std::size_t m = 0; m < island.size(); ++m)
    if (meets_itself(scene_.bodies[island[m]])) able.push_back(m);
  if (able.empty()) return step_once(island, Selves(island.size(), 0));
  std::vector<State> before;
  for (const std::size_t b : island) before.push_back(bodies_[b]->state());
  Selves selves(island.size(), 0);
  bool begun = false;  // whether those that begin in themselves are known
  const auto find_those_that_begin_so = [&] {
    bool any = false;
    for (const std::size_t m : able) {
      selves[m] = begins_in_itself(island[m], before[m].x);
      any |= selves[m] != 0;
    }
    begun = true;
    return any;
  };
  const auto is_on_clock = [&](std::size_t b) {
    const StepInputs& inputs = bodies_[b]->inputs();
    return inputs.solver.budget_ms > 0 || inputs.repeated_cuts.has_value();
  };
  if (std::ranges::any_of(island, is_on_clock)) {
    find_those_that_begin_so();
    return step_once(island, selves);
  }
  if (std::ranges::any_of(able, [&](std::size_t m) { return owns_[island[m]].touched; })) find_those_that_begin_so();
  const std::size_t touched_before = touches_.size();
  std::vector<double> wasted;  // [ms]
  for (const std::size_t b : island) wasted.push_back(std::exchange(wasted_[b], 0.0));
  for (;;) {
    const int failed = step_once(island, selves);
    if (failed >= 0 && (begun || !find_those_that_begin_so())) return failed;
    if (failed >= 0) {
      touches_.resize(touched_before);
      continue;
    }
    std::vector<std::size_t> through;
    for (const std::size_t m : able)
      if (!selves[m] && comes_through_itself(island[m], before[m].x)) through.push_back(m);
    if (through.empty()) break;
    for (std::size_t m = 0; m < island.size(); ++m) wasted[m] += bodies_[island[m]]->report().step_ms;
    if (begun || !find_those_that_begin_so()) {
      for (const std::size_t m : through) selves[m] = 1;
    }
    touches_.resize(touched_before);
    for (std::size_t m = 0; m < island.size(); ++m) bodies_[island[m]]->state_ = before[m];
  }
  for (std::size_t m = 0; m < island.size(); ++m) {
    if (wasted[m] > 0) bodies_[island[m]]->add_time(wasted[m]);
  }
  for (const std::size_t m : able) owns_[island[m]].touched = selves[m] != 0;
  return -1;
}

// With all threads inside a step, some 0.3 of it is shared. Which bodies come first changes no bits, so that the time
// of their last steps may decide.
std::vector<std::size_t> Islands::find_independent(const std::vector<std::vector<std::size_t>>& islands) const {
  constexpr double shared = 0.3, an_iteration = 1e-4;  // [ms] an element, in the first step
  if (threads_ == nullptr || threads_->count() == 1) return {};
  std::vector<std::size_t> independent;
  double sum = 0, most = 0;
  const auto work = [&](std::size_t b) {
    const double last = bodies_[b]->report().step_ms;
    return last > 0 ? last : an_iteration * bodies_[b]->model().elements * bodies_[b]->inputs().solver.iterations;
  };
  for (const std::vector<std::size_t>& island : islands) {
    const std::size_t b = island.front();
    const StepInputs& inputs = bodies_[b]->inputs();
    if (inputs.solver.budget_ms > 0 || inputs.repeated_cuts) return {};  // the others would take of its time
    if (island.size() > 1 || (owns_[b].touched && meets_itself(scene_.bodies[b]))) continue;
    independent.push_back(b);
    sum += work(b);
    most = std::max(most, work(b));
  }
  const double threads = std::min(threads_->count(), static_cast<int>(independent.size()));
  if (independent.size() < 2 || std::max(most, sum / threads) >= (1 - shared + shared / threads_->count()) * sum)
    return {};
  std::ranges::stable_sort(independent, std::greater(), work);
  return independent;
}

std::vector<std::size_t> Islands::step_at_once(const std::vector<std::size_t>& independent) {
  const Stopwatch watch;
  std::vector<char> made(independent.size(), 0);
  std::vector<std::exception_ptr> errors(independent.size());
  threads_->run(static_cast<int>(independent.size()), [&](int i) {
    try {
      made[std::size_t(i)] = step_alone(independent[std::size_t(i)]) ? 1 : 0;
    } catch (...) {
      errors[std::size_t(i)] = std::current_exception();
    }
  });
  for (const std::exception_ptr& error : errors) {
    if (error) std::rethrow_exception(error);
  }
  std::vector<std::size_t> those;
  double sum = 0;
  for (std::size_t i = 0; i < independent.size(); ++i) {
    if (!made[i]) continue;
    those.push_back(independent[i]);
    sum += bodies_[independent[i]]->report().step_ms;
  }
  saved_ms_ += std::max(0.0, sum - watch.elapsed_ms());
  return those;
}

// Makes a body's step without regard to others or itself. Returns false, and changes no state, where it fails or the
// body comes through itself.
bool Islands::step_alone(std::size_t body) {
  const bool is_able = meets_itself(scene_.bodies[body]);
  const State before = bodies_[body]->state();
  if (!bodies_[body]->step().failed && !(is_able && comes_through_itself(body, before.x))) return true;
  wasted_[body] = bodies_[body]->report().step_ms;
  bodies_[body]->state_ = before;
  return false;
}

int Islands::step_once(const std::vector<std::size_t>& island, const Selves& selves) {
  if (island.size() > 1 || selves.front()) return step_together(island, selves);
  return bodies_[island.front()]->step().failed ? static_cast<int>(island.front()) : -1;
}

int Islands::step_together(const std::vector<std::size_t>& island, const Selves& selves) {
  Together& all = together(island);
  const Model& model = all.model;
  const StepInputs& inputs = all.inputs = inputs_of(island, selves, model);
  last_step_ = {island, &model, &inputs};
  State& state = all.state;
  state = {};
  state.x.resize(model.vertices, 3);
  state.v.resize(model.vertices, 3);
  for (std::size_t p = 0; p < island.size(); ++p) {
    set_rows(model.parts[p], bodies_[island[p]]->state().x, state.x);
    set_rows(model.parts[p], bodies_[island[p]]->state().v, state.v);
    state.time = bodies_[island[p]]->state().time;
  }
  if (all.rule == nullptr) all.rule = solvers_.rule(Method::quasi_newton, model);
  OpenWorkspace& w = all.workspace.open();
  const StepReport& report = supple::step(model, inputs, state, w, *all.rule);
  if (!report.failed) note_touches(island, model, w.current.x, w.current.contacts);
  int failed = -1;
  std::int32_t first_input = 0;
  for (std::size_t p = 0; p < island.size(); ++p) {
    const Part& part = model.parts[p];
    const Positions x = rows_of(part, w.current.x);
    const std::vector<Contact> contacts = contacts_of_part(model, part, w.current.contacts, w.current.x);
    StepReport own = report_of_part(model, part, report, contacts, x);
    const int vertex = report.failure.vertex - first_input;
    if (report.failed && vertex >= 0 && vertex < part.free + part.held) {
      failed = static_cast<int>(island[p]);
      own.failure.vertex = vertex;
    }
    first_input += part.free + part.held;
    bodies_[island[p]]->take_step(x, rows_of(part, state.v), state.time, contacts, std::move(own));
  }
  return failed;
}

}  // namespace supple
