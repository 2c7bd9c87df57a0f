// Computes the energies of a body at a state, for reports, and keeps a balance of them over a film. step() does none of
// this, so its times do not contain it.
#pragma once

#include "sim/model/state.h"
#include "sim/solver/objective.h"

namespace supple {

struct Energies {
  double kinetic = 0, elastic = 0, gravitational = 0;  // the last one against the rest shape [J]
  double springs = 0;                                  // of soft handles [J]
  double contact = 0;                                  // of overlaps with colliders; not in the total [J]
  double total() const { return kinetic + elastic + gravitational + springs; }
};
// Soft handles and contact are not counted. Evaluates all elements; the workspace must be prepared for the model.
Energies energies(const Model& model, const State& state, const Vec3& gravity, Workspace& workspace);

// Holds what a body has, and what it was given, since its film began [J].
struct EnergyBalance {
  double total = 0;
  double put_in = 0;        // by handles, by contact, and by values that changed; negative where more was taken
  double from_nothing = 0;  // how far total - put_in is above the lowest that it ever was
  // The largest sum of kinetic, elastic and springs' energy so far, and all that was put in or taken: what the others
  // compare to.
  double exchanged = 0;
};

// Follows a body step by step. Damping and backward Euler itself take energy; nothing but what holds, pushes or changes
// the body from outside may give any.
class EnergyBudget {
 public:
  // Begins with a state, before what its next frame changes; `balance` is what was known there.
  void start(const Model& model, const Vec3& gravity, const State& state, Workspace& workspace,
             const EnergyBalance& balance = {});
  // Counts the springs of soft handles before the first step, where their targets are then; later steps find by
  // themselves how far these have moved. Does nothing where that is known.
  void know_springs(const Model& model, const Positions& targets, const State& state);
  bool knows_springs() const { return knows_springs_; }
  // Counts what was changed since the last step, when the inputs of the next one are there.
  void before_step(const Model& model, const StepInputs& inputs, const State& state, Workspace& workspace);
  // Counts a step that succeeded. The workspace is as it left it; q: positions before it.
  void after_step(const Model& model, const StepInputs& inputs, const Positions& q, const State& state,
                  Workspace& workspace);

  // Counts a step that was made with another energy: all that it changed came from outside.
  void after_untangling(const Model& model, const StepInputs& inputs, const State& state, Workspace& workspace);

  const EnergyBalance& balance() const { return balance_; }
  const Energies& energies() const { return parts_; }

 private:
  void add_to_budget(double work);
  void sum_up();

  Energies parts_;
  EnergyBalance balance_;
  double lowest_ = 0;  // of total - put_in
  double most_ = 0;    // of the parts that are not negative
  double moved_ = 0;   // sum of all work, each as positive
  std::uint64_t model_ = 0;
  bool knows_springs_ = false;  // their energy at the end of the last step, or before the first one
};

}  // namespace supple
