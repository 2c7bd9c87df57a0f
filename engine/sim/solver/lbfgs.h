// Computes the search directions of algorithm 2: the two-loop recursion of L-BFGS with A = M/h^2 + L as the initial
// Hessian (Liu et al. 2017, section 4.2).
#pragma once

#include <utility>

#include "sim/model/inputs.h"
#include "sim/solver/search_rule.h"

namespace supple {

// Tells where the pairs (s, t) kept so far are in the workspace's ring. The history is reset for each search.
struct PairHistory {
  int window = 0;
  int count = 0;
  int newest = -1;

  // Returns the slot of the i-th newest pair in the ring.
  int place(int i) const { return (newest - i + 2 * window) % window; }
  void clear() { count = 0; }
  // Returns false when there was nothing to forget.
  bool forget() {
    const bool some = count > 0;
    clear();
    return some;
  }
};

// Applies the inverse of the initial Hessian, A0^-1.
class InitialInverse {
 public:
  virtual ~InitialInverse() = default;
  // These functions are called when those of SearchRule are.
  virtual void begin(const Model&, const StepInputs&, OpenWorkspace&) {}
  virtual void accepted(const Model&, const StepInputs&, OpenWorkspace&) {}
  // Computes z = A0^-1 r for the free vertices; overwrites r.
  virtual void apply(const Model& model, const StepInputs& inputs, OpenWorkspace& workspace, Positions& r,
                     Positions& z) = 0;
  // Tells the same as SearchRule::measures_last_iterate.
  virtual bool measures_last_iterate() const { return false; }
  // Does what SearchRule::forget does, once no pairs are left.
  virtual bool forget() { return false; }
  // Corrects workspace.direction, after the recursion, for contacts that it would cross; returns whether it did so.
  virtual bool bend(const Model&, const StepInputs&, OpenWorkspace&) { return false; }
};

// Sets workspace.direction to -H grad with H the L-BFGS approximation of the inverse Hessian; returns tr(grad^T d).
double search_direction(const Model& model, const StepInputs& inputs, OpenWorkspace& workspace,
                        const PairHistory& history, InitialInverse& initial);

// Stores s and t, the differences of positions and gradients between trial and current iterate, without the forces of
// contacts, as the newest pair when tr(s^T t) is safely positive. search_direction() adds the stiffness of the contacts
// in force to all pairs.
void remember_pair(const Model& model, OpenWorkspace& workspace, PairHistory& history);

// Tells whether s.t, of a pair with these s.s and t.t, is more than round-off. Curvature along s that is negative or
// lost in round-off would spoil the matrix: Nocedal and Wright 2006, section 7.2, skip such pairs.
bool is_safely_positive(double st, double ss, double tt);

// Implements L-BFGS from any initial Hessian, which must outlive this object. The settings contain the window.
class LbfgsRule : public SearchRule {
 public:
  explicit LbfgsRule(InitialInverse& initial) : initial_(initial) {}

  void begin(const Model& model, const StepInputs& inputs, OpenWorkspace& workspace) override {
    history_ = {inputs.solver.history};
    initial_.begin(model, inputs, workspace);
  }
  double direction(const Model& model, const StepInputs& inputs, OpenWorkspace& workspace) override {
    return search_direction(model, inputs, workspace, history_, initial_);
  }
  void accepted(const Model& model, const StepInputs& inputs, OpenWorkspace& workspace) override {
    initial_.accepted(model, inputs, workspace);
    remember_pair(model, workspace, history_);
  }
  bool measures_last_iterate() const override { return initial_.measures_last_iterate(); }
  bool takes_single() const override { return true; }
  bool forget() override { return history_.forget() || initial_.forget(); }

 private:
  InitialInverse& initial_;
  PairHistory history_;
};

// Starts directions from the matrix in force, OpenWorkspace::system, by its factor, with contacts as in
// contact_direction.h: the paper's A = M/h^2 + L, with its second level (coarse/second_level.h) where the settings ask
// for it, or one that follows the body (matrix_rule.h).
class SystemInverse final : public InitialInverse {
 public:
  void begin(const Model& model, const StepInputs& inputs, OpenWorkspace& workspace) override;
  void apply(const Model& model, const StepInputs& inputs, OpenWorkspace& workspace, Positions& r,
             Positions& z) override;
  bool measures_last_iterate() const override { return true; }
  bool bend(const Model& model, const StepInputs& inputs, OpenWorkspace& workspace) override;
  // Goes on with the first level alone, where directions of both levels came to nothing.
  bool forget() override { return std::exchange(has_second_level_, false); }

 private:
  bool has_second_level_ = false;
  int iterations_ = 0;  // StepReport::iterations at the iterate to which Z belongs
};

}  // namespace supple
