// Defines the interface of rules: a rule chooses the direction in which an iteration looks for the next iterate. step()
// has the quasi-Newton rule. Other solvers put their own rule into the same loop, and share its first iterate, line
// search, contacts and report.
#pragma once

namespace supple {

struct Model;
struct OpenWorkspace;
struct StepInputs;

class SearchRule {
 public:
  virtual ~SearchRule() = default;

  // This is called at the start of each search, when workspace.current is the first iterate with its gradient and
  // energies. A step makes a second search when it starts again from where the body was.
  virtual void begin(const Model&, const StepInputs&, OpenWorkspace&) {}

  // Sets workspace.direction at workspace.current; returns tr(grad^T d).
  virtual double direction(const Model& model, const StepInputs& inputs, OpenWorkspace& workspace) = 0;

  // This is called when the trial iterate was accepted and is about to become the current one. The gradients of both
  // iterates still contain the contacts of the current iterate, which the search used.
  virtual void accepted(const Model&, const StepInputs&, OpenWorkspace&) {}

  // Tells whether one more direction is computed after the last iteration, to estimate the error there by Newton's
  // decrement.
  virtual bool measures_last_iterate() const { return false; }

  // Tells whether the rule reads the gradients of iterates. Where it does not and no line search is made, they are not
  // computed.
  virtual bool needs_gradient() const { return true; }

  // Tells whether gradients of single precision serve the rule (element_precision.h).
  virtual bool takes_single() const { return false; }

  // Forgets what was learned in earlier iterations, when the direction was of no use. Returns false when there was
  // nothing to forget.
  virtual bool forget() { return false; }
};

}  // namespace supple
