#include "world/islands.h"

#include <algorithm>
#include <exception>
#include <functional>
#include <map>
#include <utility>

#include "base/timing.h"
#include "base/trace.h"
#include "scene/definition/meeting.h"
#include "scene/definition/scene_def.h"
#include "sim/contact/own_sheet.h"
#include "sim/contact/own_surface.h"
#include "sim/contact/part_contacts.h"
#include "sim/model/element_view.h"
#include "sim/model/flow_step.h"
#include "sim/model/joined_model.h"
#include "sim/solver/search_rule.h"
#include "sim/solver/step.h"

namespace supple {
namespace {

constexpr std::size_t most_kept = 16;  // joined models that are kept for later steps

}  // namespace

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
  bool touched = false;  // in the last step; the next one is then tested before it is made, which saves work alone
};

Islands::Islands(const SceneDef& scene, const std::vector<std::unique_ptr<MovingBody>>& bodies, const Solvers& solvers,
                 Threads* threads)
    : scene_(scene),
      bodies_(bodies),
      solvers_(solvers),
      threads_(threads),
      finder_(scene, bodies),
      restitution_(scene, bodies),
      owns_(bodies.size()),
      wasted_(bodies.size(), 0.0) {}
Islands::~Islands() = default;

std::vector<std::vector<std::size_t>> Islands::find() {
  touches_.clear();
  saved_ms_ = 0;
  return finder_.find();
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
  show_flow(models, together_.front()->model);
  return *together_.front();
}

// Returns the inputs of an island's step. It is solved by the quasi-Newton method, because matrices of other methods
// have no room for contacts between bodies, with the settings of the first body and as many iterations as any body asks
// for.
StepInputs Islands::inputs_of(const std::vector<std::size_t>& island, const Selves& selves, const Model& joined) const {
  StepInputs inputs = bodies_[island.front()]->inputs();
  inputs.solver = solvers_.settings(Method::quasi_newton, scene_.bodies[island.front()].solver.settings);
  inputs.solver.matrix = StartMatrix::system;
  inputs.solver.budget_ms = bodies_[island.front()]->inputs().solver.budget_ms;  // none where cuts are repeated
  inputs.targets.resize(std::ssize(joined.handled), 3);
  inputs.middle_targets.resize(joined.scheme.theta < 1 ? std::ssize(joined.handled) : 0, 3);
  Eigen::Index row = 0;
  bool any_air = false, any_seams = false;
  for (const std::size_t b : island) {
    const StepInputs& own = bodies_[b]->inputs();
    inputs.targets.middleRows(row, own.targets.rows()) = own.targets;
    if (joined.scheme.theta < 1) inputs.middle_targets.middleRows(row, own.targets.rows()) = own.middle_targets;
    row += own.targets.rows();
    any_air |= !own.air.empty();
    any_seams |= !own.seams.empty();
    inputs.solver.iterations = std::max(inputs.solver.iterations, own.solver.iterations);
  }
  inputs.air.clear();
  for (std::size_t p = 0; any_air && p < island.size(); ++p) {
    const std::vector<PartAir>& own = bodies_[island[p]]->inputs().air;
    inputs.air.push_back(own.empty() ? PartAir{} : own.front());
  }
  inputs.seams.clear();
  for (std::size_t p = 0; any_seams && p < island.size(); ++p) {
    const std::vector<SeamOpening>& own = bodies_[island[p]]->inputs().seams;
    inputs.seams.push_back(own.empty() ? SeamOpening{} : own.front());
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

// Returns the report of one body for a step of several. Times are the body's share of the step, by free vertices.
// Forces, contacts in force and the estimated error of motion are the body's own, where a contact between two bodies
// counts in both. Iterations, energies, the error of equation 12 and all else are those of the whole step.
StepReport report_of_part(const Model& joined, std::size_t number, const StepReport& all,
                          const std::vector<Contact>& contacts, const Positions& x) {
  const Part& part = joined.parts[number];
  StepReport report = all;
  if (!all.motion_estimates.empty()) report.motion_estimate = all.motion_estimates[number];
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

// Returns the place of a contact between two surfaces, on the one whose vertices have positive weights; those of the
// other surface have negative ones.
Vec3 place_of_point(const ContactStencil& stencil, const Positions& x) {
  Vec3 place = Vec3::Zero();
  for (int k = 0; k < stencil.count; ++k) place += std::max(0.0, stencil.weight[k]) * x.row(stencil.vertex[k]);
  return place;
}

}  // namespace

void Islands::note_touches(const std::vector<std::size_t>& island, const Model& joined, const Positions& x,
                           const std::vector<Contact>& contacts) {
  std::map<std::pair<std::size_t, std::size_t>, BodyTouch> by_pair;
  for (const Contact& contact : contacts) {
    if (contact.other.is_collider()) continue;
    const std::size_t point = island[joined.part_number(contact.number)], other = island[contact.other.part];
    const auto [a, b] = std::pair(std::min(point, other), std::max(point, other));
    // A depth counts from the other surface, where n . u = 0, and not from the plane.
    const double above = gap(contact, x), inside = -(above + contact.offset);
    if (above >= 0 && inside <= 0) continue;
    BodyTouch& touch = by_pair.try_emplace({a, b}, BodyTouch{.a = a, .b = b}).first->second;
    ++touch.contacts;
    touch.depth = std::max(touch.depth, inside);
    const double pressing = -2 * contact.stiffness * std::min(0.0, above);
    touch.force += (point == b ? pressing : -pressing) * contact.normal;
    touch.pressing += pressing;
    touch.place += pressing * place_of_point(contact.stencil, x);
  }
  for (auto& [pair, touch] : by_pair) {
    if (touch.pressing > 0) touch.place /= touch.pressing;
    touches_.push_back(touch);
  }
  std::ranges::sort(touches_, {}, [](const BodyTouch& touch) { return std::pair(touch.a, touch.b); });
}

Islands::Own& Islands::own_of(std::size_t body) {
  Own& own = owns_[body];
  const Model& model = bodies_[body]->model();
  if (own.structure == model.structure) return own;
  own.structure = model.structure;
  own.moving = std::make_unique<MovingSurface>(model.surface, model.rest);
  if (model.parts.front().solid) {
    own.surface = std::make_unique<OwnSurface>(tetrahedra_of(model), *own.moving, model.rest, model.size);
  } else {
    own.sheet = std::make_unique<OwnSheet>(*own.moving, model.rest, joined_by_seams(model.seams.pairs));
  }
  own.touched = false;
  return own;
}

bool Islands::begins_in_itself(std::size_t body, const Positions& q) {
  const Own& own = own_of(body);
  if (own.sheet == nullptr) return own.surface->overlaps(*own.moving, q);
  own.moving->set_end(q);
  own.moving->set_start(q);
  return own.sheet->overlaps(*own.moving, q);
}

bool Islands::comes_through_itself(std::size_t body, const Positions& q) {
  const Zone zone("touching itself");
  const Own& own = own_of(body);
  const Positions& x = bodies_[body]->state().x;
  const Vec3 carried = (x - q).colwise().mean().transpose();
  if (own.sheet == nullptr) return own.surface->touches(*own.moving, q, x, carried);
  own.moving->set_start(q);
  own.moving->set_end(x);
  return own.sheet->touches(*own.moving, q, x, carried);
}

int Islands::step(const std::vector<std::size_t>& island) {
  restitution_.before_step(island);
  const int failed = step_without_bounce(island);
  if (failed < 0) restitution_.after_step(island, touches_);
  return failed;
}

// Makes the step of an island, in which those bodies that touch themselves have contact with themselves. Which ones
// these are must follow from the states alone, and not from whether a body was tested before its step or after it:
// those that begin inside themselves come first, then those that come through themselves in a step in which the first
// ones have this contact. A step with a budget of time is made once, with contact of those that begin inside themselves
// alone: its cuts are repeated in other runs, where those of a step that is thrown away are not known.
int Islands::step_without_bounce(const std::vector<std::size_t>& island) {
  std::vector<std::size_t> able;  // the island's members that meet themselves
  for (std::size_t m = 0; m < island.size(); ++m)
    if (meets_itself(scene_.bodies[island[m]])) able.push_back(m);
  if (able.empty()) return step_once(island, Selves(island.size(), 0));
  std::vector<State> before;
  for (const std::size_t b : island) before.push_back(bodies_[b]->state());
  Selves selves(island.size(), 0);
  bool inside_known = false;  // whether it is known which bodies begin inside themselves
  // Finds these bodies, which get contact with themselves. Returns whether there are any.
  const auto find_inside = [&] {
    bool any = false;
    for (const std::size_t m : able) {
      selves[m] = begins_in_itself(island[m], before[m].x);
      any |= selves[m] != 0;
    }
    inside_known = true;
    return any;
  };
  const auto undo_step = [&] {
    std::erase_if(touches_, [&](const BodyTouch& touch) { return std::ranges::find(island, touch.a) != island.end(); });
    for (std::size_t m = 0; m < island.size(); ++m) bodies_[island[m]]->state_ = before[m];
  };
  const auto is_on_clock = [&](std::size_t b) { return has_time_budget(bodies_[b]->inputs()); };
  if (std::ranges::any_of(island, is_on_clock)) {
    find_inside();
    return step_once(island, selves);
  }
  if (std::ranges::any_of(able, [&](std::size_t m) { return owns_[island[m]].touched; })) find_inside();
  std::vector<double> wasted;  // [ms]
  for (const std::size_t b : island) wasted.push_back(std::exchange(wasted_[b], 0.0));
  for (;;) {
    const int failed = step_once(island, selves);
    if (failed >= 0) {
      if (inside_known || !find_inside()) return failed;
      undo_step();
      continue;
    }
    std::vector<std::size_t> through;
    for (const std::size_t m : able)
      if (!selves[m] && comes_through_itself(island[m], before[m].x)) through.push_back(m);
    if (through.empty()) break;
    for (std::size_t m = 0; m < island.size(); ++m) wasted[m] += bodies_[island[m]]->report().step_ms;
    if (inside_known || !find_inside()) {
      for (const std::size_t m : through) selves[m] = 1;
    }
    undo_step();
  }
  for (std::size_t m = 0; m < island.size(); ++m) {
    if (wasted[m] > 0) bodies_[island[m]]->add_time(wasted[m]);
  }
  for (const std::size_t m : able) owns_[island[m]].touched = selves[m] != 0;
  return -1;
}

// Threads that all work inside one step share some 0.3 of its time; one of them does the rest. Neither the choice of
// the bodies nor their order changes any bits, so that measured times may decide both.
std::vector<std::size_t> Islands::find_independent(const std::vector<std::vector<std::size_t>>& islands) const {
  constexpr double shared = 0.3, an_iteration = 1e-4;  // the second: by element, where no step was made yet [ms]
  if (threads_ == nullptr || threads_->count() == 1) return {};
  std::vector<std::size_t> independent;
  double sum = 0, most = 0;
  const auto work = [&](std::size_t b) {
    const double last = bodies_[b]->report().step_ms;
    return last > 0 ? last : an_iteration * bodies_[b]->model().elements * bodies_[b]->inputs().solver.iterations;
  };
  for (const std::vector<std::size_t>& island : islands) {
    const std::size_t b = island.front();
    if (has_time_budget(bodies_[b]->inputs())) return {};  // steps of others at the same time would use up its budget
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
  restitution_.before_step({body});
  const bool is_able = meets_itself(scene_.bodies[body]);
  const State before = bodies_[body]->state();
  if (!bodies_[body]->step().failed && !(is_able && comes_through_itself(body, before.x))) {
    restitution_.after_step({body}, touches_);
    return true;
  }
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
    StepReport own = report_of_part(model, p, report, contacts, x);
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
