#include "sim/measures/energies.h"

#include <algorithm>
#include <cmath>

#include "sim/contact/find_contacts.h"
#include "sim/model/bending.h"
#include "sim/solver/begin_step.h"
#include "sim/solver/energy_gain.h"
#include "sim/solver/objective.h"

namespace supple {
namespace {

void set_motion(const Model& model, const State& state, const Vec3& gravity, Energies& parts) {
  parts.kinetic = parts.gravitational = 0;
  for (int v = 0; v < model.free; ++v) {
    parts.kinetic += 0.5 * model.mass[v] * state.v.row(v).squaredNorm();
    parts.gravitational -= model.mass[v] * (state.x.row(v) - model.rest.row(v)).dot(gravity);
  }
}

double spring_energy(const Model& model, const Positions& targets, const Positions& x) {
  double sum = 0;
  for (std::size_t i = 0; i < model.handled.size(); ++i) {
    const std::int32_t v = model.handled[i].vertex;
    if (v < model.free && model.handled[i].holds)
      sum += 0.5 * model.handle_stiffness[v] * (x.row(v) - targets.row(static_cast<Eigen::Index>(i))).squaredNorm();
  }
  return sum;
}

// Returns the work of seams whose gaps close from `before` to `gaps` in a step from q to x [J]. In a step that is
// solved, this is the work by the forces at x. In other steps, those are not the forces that moved the cloth: there the
// work is what the body gained, if that is more, up to the energy by which the seams are stretched when their gaps
// shrink at q. gained: by the body in the step, without the work of all else.
double work_of_closing(const Model& model, const Positions& before, const Positions& gaps, const Positions& q,
                       const Positions& x, double gained) {
  double work = 0, most = 0;
  for (std::size_t p = 0; p < model.seams.pairs.size(); ++p) {
    const SeamPair& pair = model.seams.pairs[p];
    const auto row = static_cast<Eigen::Index>(p);
    const Vec3 gap = gaps.row(row), closed = gap - before.row(row).transpose(), apart = pair.apart(q.data()) - gap;
    work -= pair.stiffness * closed.dot(pair.apart(x.data()) - gap);
    most -= pair.stiffness * closed.dot(apart + 0.5 * closed);
  }
  return std::clamp(gained, work, std::max(work, most));
}

// Returns the work over a step from q to x of a contact with another body, or of a body with itself, on the free
// vertices of the contact's stencil [J]. force: on the stencil's point [N]. A force that pushes the point out gives
// energy. A force that stops the point takes no more than the other side receives, which moves away by less: the rest
// is lost in the impact. Otherwise a step that is left with a large force at a stiff contact would count as one that
// took far more than the body ever had.
double work_between_bodies(const Contact& contact, const Vec3& force, const Positions& q, const Positions& x) {
  const Vec3 way = contact.stencil.of_free(x) - contact.stencil.of_free(q);
  const double pressing = force.dot(contact.normal);
  const double own = pressing * way.dot(contact.normal);
  const double of_other = pressing * (contact.origin - contact.stencil.at(q)).dot(contact.normal);
  const double friction = force.dot(way) - own;
  return friction + (own >= 0 ? own : std::clamp(of_other, own, 0.0));
}

// Returns the work of a contact with a collider over a step from q to x [J]: that of all forces along the way of the
// collider, and of friction along the way on the collider. The normal force on a collider that stands does no work,
// although a vertex that comes down on it, as those of a rolling ball do, has a way; only a vertex that is pushed out
// gains energy. force: on all free vertices.
double work_of_collider(const StepInputs& inputs, const Contact& contact, const Vec3& force, const Positions& q,
                        const Positions& x) {
  const Vec3 from = contact.stencil.at(q), carried = carried_by(inputs, contact.other.collider, from) - from;
  const Vec3 slip = contact.stencil.at(x) - from - carried;
  const double pressing = force.dot(contact.normal), away = slip.dot(contact.normal);
  return force.dot(carried) + force.dot(slip) - pressing * away + pressing * std::max(0.0, away);
}

// Returns the work of contacts over a step from q to the current iterate [J].
double work_of_contacts(const StepInputs& inputs, const Positions& q, OpenWorkspace& w) {
  const Positions& x = w.current.x;
  std::vector<Contact> one(1);
  double work = 0;
  for (const Contact& contact : w.current.contacts) {
    const ContactStencil& stencil = contact.stencil;
    one.front() = contact;
    for (int k = 0; k < stencil.free; ++k) w.scratch.row(stencil.vertex[k]).setZero();
    add_contacts(one, x, nullptr, w.direction, &w.scratch, -1);
    if (contact.other.is_collider()) {
      Vec3 force = Vec3::Zero();
      for (int k = 0; k < stencil.free; ++k) force += w.scratch.row(stencil.vertex[k]).transpose();
      work += work_of_collider(inputs, contact, force, q, x);
    } else {
      const Vec3 force = w.scratch.row(stencil.vertex[0]).transpose() / stencil.weight[0];
      work += work_between_bodies(contact, force, q, x);
    }
  }
  return work;
}

}  // namespace

Energies energies(const Model& model, const State& state, const Vec3& gravity, OpenWorkspace& w) {
  Energies result;
  set_motion(model, state, gravity, result);
  result.elastic = elastic_energy(model, w, state.x);
  return result;
}

void EnergyBudget::start(const Model& model, const StepInputs& inputs, const State& state, OpenWorkspace& w,
                         const EnergyBalance& balance) {
  parts_ = supple::energies(model, state, inputs.gravity, w);
  begin_air(model, inputs, state, w.air);
  parts_.gas = w.air.gas_energy(model, state.x);
  balance_ = balance;
  balance_.total = parts_.total();
  balance_.flowed = known_flow_ = state.flow.lost;
  known_bounces_ = state.bounces.given;
  lowest_ = balance_.total - balance_.put_in - balance_.from_nothing;
  model_ = model.id;
  knows_springs_ = false;
}

void EnergyBudget::add_to_budget(double work) {
  balance_.put_in += work;
  balance_.worked += std::abs(work);
}

void EnergyBudget::count_bounces(const State& state) {
  if (state.bounces.given == known_bounces_) return;
  add_to_budget(state.bounces.given - known_bounces_);
  known_bounces_ = state.bounces.given;
}

void EnergyBudget::know_springs(const Model& model, const Positions& targets, const std::vector<SeamOpening>& seams,
                                const State& state) {
  if (knows_springs_) return;
  open_gaps(model, seams, &SeamOpening::end, seam_gaps_);
  parts_.springs = spring_energy(model, targets, state.x) + seam_energy(model, seam_gaps_, state.x);
  lowest_ += parts_.springs;  // start() has left them out
  knows_springs_ = true;
}

void EnergyBudget::before_step(const Model& model, const StepInputs& inputs, const State& state, OpenWorkspace& w) {
  Energies now = parts_;
  set_motion(model, state, inputs.gravity, now);
  const double flowed = state.flow.lost - known_flow_;
  now.elastic -= flowed;
  parts_.elastic -= flowed;
  balance_.flowed = known_flow_ = state.flow.lost;
  if (model.id != model_) now.elastic = elastic_energy(model, w, state.x);
  know_springs(model, inputs.targets, inputs.seams, state);
  now.springs = spring_energy(model, inputs.targets, state.x) + seam_energy(model, seam_gaps_, state.x);
  begin_air(model, inputs, state, w.air);
  now.gas = w.air.gas_energy(model, state.x);
  begin_seams(model, inputs, w);
  add_to_budget(now.total() - parts_.total());
  parts_ = now;
  model_ = model.id;
}

void EnergyBudget::after_step(const Model& model, const StepInputs& inputs, const Positions& q, const State& state,
                              OpenWorkspace& w) {
  const double total_before = parts_.total(), put_in_before = balance_.put_in;
  const Positions gaps_before = seam_gaps_;
  open_gaps(model, inputs.seams, &SeamOpening::end, seam_gaps_);
  if (model.free < model.vertices) add_to_budget(work_of_handles(model, q, w));
  if (!w.current.contacts.empty()) add_to_budget(work_of_contacts(inputs, q, w));
  // before_step() has begun the forces of air and seams, also for a body whose step was made in a model of several.
  if (w.air.act()) add_to_budget(w.air.work(model, state.x));
  count_bounces(state);
  set_motion(model, state, inputs.gravity, parts_);
  // A body's own step of backward Euler has evaluated the elements where it ends. The step of an island has not done so
  // for each body, and leaves a number that is not finite.
  const bool is_known = model.scheme.theta == 1 && std::isfinite(w.current.elastic);
  parts_.elastic = is_known ? w.current.elastic + bending_energy(model, state.x) : elastic_energy(model, w, state.x);
  parts_.springs = spring_energy(model, inputs.targets, state.x) + seam_energy(model, seam_gaps_, state.x);
  parts_.gas = w.air.gas_energy(model, state.x);
  parts_.contact = contact_energy(w.current.contacts, state.x);
  if (!model.seams.empty()) {
    const double gained = parts_.total() - total_before - (balance_.put_in - put_in_before);
    add_to_budget(work_of_closing(model, gaps_before, seam_gaps_, q, state.x, gained));
  }
  sum_up();
}

void EnergyBudget::sum_up() {
  balance_.total = parts_.total();
  const double own = balance_.total - balance_.put_in;
  lowest_ = std::min(lowest_, own);
  balance_.from_nothing = own - lowest_;
  const double held = parts_.kinetic + std::abs(parts_.elastic) + parts_.springs + std::abs(parts_.gas);
  balance_.held = std::max(balance_.held, held);
}

void EnergyBudget::after_untangling(const Model& model, const StepInputs& inputs, const State& state,
                                    OpenWorkspace& w) {
  const double before = parts_.total();
  open_gaps(model, inputs.seams, &SeamOpening::end, seam_gaps_);
  set_motion(model, state, inputs.gravity, parts_);
  parts_.elastic = elastic_energy(model, w, state.x);
  parts_.springs = spring_energy(model, inputs.targets, state.x) + seam_energy(model, seam_gaps_, state.x);
  parts_.gas = w.air.gas_energy(model, state.x);
  parts_.contact = contact_energy(w.current.contacts, state.x);
  add_to_budget(parts_.total() - before);
  known_bounces_ = state.bounces.given;
  sum_up();
}

}  // namespace supple
