#include "sim/solver/newton_system.h"

#include <cmath>
#include <vector>

#include "sim/linear/changing_factor.h"
#include "sim/model/system_solve.h"
#include "sim/model/turned_hessian_system.h"
#include "sim/solver/hessian_matrix.h"
#include "sim/solver/open_workspace.h"

namespace supple {

struct NewtonSystem::Parts {
  std::uint64_t structure;
  HessianMatrix hessian;
  ChangingFactor factor;
  std::vector<Mat3> stiffness;  // by contact of the current iterate, with that of planes ahead that were added [N/m]
  Positions right, pushed;      // n_free x 3 [N]

  explicit Parts(const Model& of) : structure(of.structure), hessian(of), factor(of.factor.precision()) {
    factor.analyze(hessian.matrix());
  }
  void assemble(const Model& model, OpenWorkspace& w);
  bool take_planes_ahead(const Iterate& at, const Positions& direction);
  bool solve(const Model& model, OpenWorkspace& w);
};

NewtonSystem::NewtonSystem() = default;
NewtonSystem::~NewtonSystem() = default;
NewtonSystem::NewtonSystem(NewtonSystem&&) noexcept = default;
NewtonSystem& NewtonSystem::operator=(NewtonSystem&&) noexcept = default;

void NewtonSystem::Parts::assemble(const Model& model, OpenWorkspace& w) {
  hessian.assemble(model, w, true);
  right = w.current.gradient;
  stiffness.clear();
  for (const Contact& contact : w.current.contacts) stiffness.push_back(stiffness_of(contact, w.current.x));
}

// Adds the energies k (gap + n . d)^2 of planes that the direction leads through to the quadratic model: 2 k n n^T to
// its Hessian, 2 k gap n to its gradient. Returns whether any of these planes was new to the model.
bool NewtonSystem::Parts::take_planes_ahead(const Iterate& at, const Positions& direction) {
  bool some = false;
  for (std::size_t i = 0; i < at.contacts.size(); ++i) {
    const Contact& contact = at.contacts[i];
    const Vec3& n = contact.normal;
    const double here = gap(contact, at.x), k = 2 * contact.stiffness;
    const bool is_held = n.dot(stiffness[i] * n) > contact.stiffness;
    if (is_held || here + n.dot(contact.stencil.of_free(direction)) >= 0) continue;
    some = true;
    hessian.add_stiffness(contact.stencil, k * n * n.transpose());
    stiffness[i] += k * n * n.transpose();
    contact.stencil.spread(k * here * n, right);
  }
  return some;
}

// Solves for the direction. A body that nothing holds then gets its translation as Newton's law says, because a factor
// in single precision does not keep momentum to round-off.
bool NewtonSystem::Parts::solve(const Model& model, OpenWorkspace& w) {
  const std::vector<Contact>& contacts = w.current.contacts;
  Positions& direction = w.direction;
  if (!try_factorize_projected(hessian, factor)) {
    direction.setZero();
    return false;
  }
  factor.solve(right.data(), direction.data());
  if (w.air.fixed_amounts() > 0) {
    w.gas.begin(model, w.air, w.current.x,
                [&](const Positions& force, Positions& motion) { factor.solve(force.data(), motion.data()); });
    w.gas.correct(direction);
  }
  // Drag resists translations, too, so that they do not follow from inertia alone.
  if (std::ranges::any_of(model.parts, &Part::floats) && !w.air.have_drag()) {
    pushed = right;
    for (std::size_t i = 0; i < contacts.size(); ++i)
      contacts[i].stencil.spread(-(stiffness[i] * contacts[i].stencil.of_free(direction)), pushed);
    restore_translation(model, pushed, direction);
  }
  direction = -direction;
  return true;
}

double NewtonSystem::direction(const Model& model, const StepInputs& inputs, OpenWorkspace& w) {
  constexpr int most_corrections = 3;
  const TimedPhase timed(w.clock, Phase::solve, "Newton");
  if (!parts_ || parts_->structure != model.structure || parts_->factor.precision() != model.factor.precision())
    parts_ = std::make_unique<Parts>(model);
  Parts& p = *parts_;
  const Iterate& at = w.current;
  const auto slope_of = [&] { return (at.gradient.array() * w.direction.array()).sum(); };
  p.assemble(model, w);
  if (!p.solve(model, w)) return 0;
  double slope = slope_of();
  if (!std::isfinite(slope)) {
    w.direction.setZero();
    return 0;
  }
  if (inputs.solver.contact.direction != ContactDirection::low_rank) return slope;
  for (int i = 0; i < most_corrections && p.take_planes_ahead(at, w.direction); ++i) {
    w.correction.unbent = w.direction;
    if (!p.solve(model, w) || !(slope_of() < 0)) {
      w.direction = w.correction.unbent;
      break;
    }
    slope = slope_of();
  }
  return slope;
}

// The factor is that of A with 3 x 3 blocks in place of numbers.
double newton_cost(const Model& model) { return cost_of_hessian(model, 27.0 * model.factor.operations()); }

}  // namespace supple
