#include "sim/solver/first_forces.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sim/contact/collider_view.h"
#include "sim/solver/first_iterate.h"
#include "sim/solver/iterations.h"
#include "sim/solver/lbfgs.h"

namespace supple {
namespace {

// Friction tips a body forward, so that its front presses more than its back. The first round knows only the friction
// of vertices that arrive, and each further round uses the forces of the round before. With one round, a cube that
// slides with a coefficient of 0.5 has 86 % of its friction, and with four rounds more than 98 %.
constexpr int rounds = 4;
constexpr double touching = 1e-6;  // distance within which a vertex touches, over the body's size

// Tells which vertices touch a collider with friction as the step begins, colliders x free; empty where none does.
std::vector<char> touching_vertices(const Model& model, const StepInputs& inputs, const Positions& x) {
  std::vector<char> found;
  const Positions drawn = drawn_offsets(model, x, nullptr);
  for (std::size_t c = 0; c < inputs.colliders->size(); ++c) {
    const Collider& collider = (*inputs.colliders)[c];
    if (collider.friction <= 0) continue;
    const ColliderView view(collider, inputs.collider_motions[c], {});
    for (int v = 0; v < model.free; ++v) {
      Vec3 place = x.row(v).transpose();
      if (drawn.rows() > 0) place += drawn.row(v).transpose();
      const double distance = collider.shape.distance(view.at_start(place)) - collider.thickness;
      if (std::abs(distance) > touching * model.part_of(v).size) continue;
      found.resize(inputs.colliders->size() * std::size_t(model.free), 0);
      found[c * std::size_t(model.free) + v] = 1;
    }
  }
  return found;
}

// Makes one step whose friction follows from the given depths, and replaces these by the depths at which the touching
// vertices end. Returns false where the step fails.
bool press_once(const Model& model, const StepInputs& inputs, const State& state, const std::vector<char>& touches,
                OpenWorkspace& w, std::vector<double>& pressed) {
  w.prepare(model, inputs.solver);
  w.report = {};
  begin_step(model, inputs, state, w);
  w.contact.pressed_at_first = pressed;
  SystemInverse system;
  LbfgsRule rule(system);
  StepContext context{model, inputs, state, w, rule};
  set_first_iterate(context);
  minimize(model, inputs, w, rule);
  if (w.report.failed || !w.current.x.allFinite()) return false;
  pressed.assign(touches.size(), 0);
  for (const Contact& contact : w.current.contacts) {
    if (!contact.other.is_collider() || contact.number >= model.free) continue;
    const std::size_t at = contact.other.collider * std::size_t(model.free) + contact.number;
    if (touches[at] != 0) pressed[at] = std::max(0.0, -gap(contact, w.current.x));
  }
  return true;
}

}  // namespace

void find_first_forces(const Model& model, const StepInputs& inputs, const State& state, OpenWorkspace& w) {
  if (state.time != 0) return;
  const std::vector<char> touches = touching_vertices(model, inputs, state.x);
  if (touches.empty()) return;
  StepInputs own = inputs;
  own.solver = {};
  own.solver.contact = inputs.solver.contact;
  own.repeated_cuts.reset();
  State later = state;
  later.time = model.time_step;  // not 0, so that this step does not look for first forces itself
  OpenWorkspace own_workspace;
  own_workspace.threads = w.threads;
  std::swap(own_workspace.second_level, w.second_level);  // its clusters take long to find
  std::vector<double> pressed;
  int round = 0;
  while (round < rounds && press_once(model, own, later, touches, own_workspace, pressed)) ++round;
  std::swap(own_workspace.second_level, w.second_level);
  if (round == rounds) w.contact.pressed_at_first = std::move(pressed);
}

}  // namespace supple
