// Search directions of algorithm 2: the two-loop recursion of L-BFGS with A = M/h^2 + L as the initial Hessian (Liu et
// al. 2017, section 4.2).
#pragma once

#include "sim/objective.h"

namespace supple {

// The pairs (s, t) kept so far live in the workspace's ring; this is the ring's bookkeeping. Made anew each step.
struct PairHistory {
  int window = 0;
  int count = 0;
  int newest = -1;

  // The i-th newest pair's place in the ring.
  int place(int i) const { return (newest - i + 2 * window) % window; }
  void clear() { count = 0; }
};

// workspace.direction = -H grad with H the L-BFGS approximation of the inverse Hessian, bent where it would cross
// contact planes (contact_direction.h); returns tr(grad^T d). Adds the
// milliseconds of the solve and of the rest to the report.
double search_direction(const Model& model, const ContactSettings& contact, Workspace& workspace,
                        const PairHistory& history);

// Keeps s = trial - x and t = trial_gradient - gradient (without the normal forces of contacts, when their stiffness is
// added anew each time) as the newest pair when tr(s^T t) is safely positive.
void remember_pair(const Model& model, const ContactSettings& contact, Workspace& workspace, PairHistory& history);

}  // namespace supple
