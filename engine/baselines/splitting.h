// Implements ADMM (Overby, Brown, Li, Narain 2017, "ADMM ⊇ projective dynamics"): each element has a deformation of
// its own, which a local step finds (element_proximal.h), and multipliers that tie it to the positions, which the
// global step finds with the factor of A. The weights of the ties are those of L.
#pragma once

#include "base/aligned.h"
#include "baselines/local_kernels.h"
#include "sim/solver/search_rule.h"

namespace supple {

// An iteration makes the local step at the current iterate and then the global one. Its direction leads to the
// positions that the global step finds, and is followed to its end.
class SplittingRule final : public SearchRule {
 public:
  void begin(const Model& model, const StepInputs& inputs, OpenWorkspace& workspace) override;
  double direction(const Model& model, const StepInputs& inputs, OpenWorkspace& workspace) override;
  bool needs_gradient() const override { return false; }

 private:
  void make_local_steps(const Model& model, OpenWorkspace& workspace);

  AlignedVector<double> multipliers_;  // u, by block, most_multipliers x block_width
  bool start_ = true;                  // whether the multipliers have no values yet
};

}  // namespace supple
