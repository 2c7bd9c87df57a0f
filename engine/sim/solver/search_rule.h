// Where an iteration looks for the next iterate: what solvers of one kind differ in. step() has the quasi-Newton rule;
// others plug theirs into the same loop, and share first iterate, line search, contacts and report with it.
#pragma once

#include "sim/solver/objective.h"

namespace supple {

class SearchRule {
 public:
  virtual ~SearchRule() = default;

  // Once a step, before anything is looked at: workspace.x is the first iterate, its gradient and energies are at hand.
  virtual void begin(const Model&, const FrameInputs&, Workspace&) {}

  // workspace.direction from workspace.gradient at workspace.x; returns tr(grad^T d). workspace.trial_gradient is
  // scratch.
  virtual double direction(const Model& model, const FrameInputs& inputs, Workspace& workspace) = 0;

  // A trial point was accepted; x, gradient and trial, trial_gradient, both with the planes that the search went by.
  virtual void accepted(const Model&, const FrameInputs&, Workspace&) {}

  // The contacts of the new iterate are not those of the last.
  virtual void contacts_changed(const FrameInputs&) {}

  // Forgets what earlier iterations taught, when the direction was of no use. False when there was nothing to forget.
  virtual bool forget() { return false; }
};

}  // namespace supple
