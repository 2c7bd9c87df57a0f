// Computes the energies of a body at a state, for reports, and keeps a balance of them over a film. step() does none of
// this, so its times do not contain it.
#pragma once

#include "sim/model/inputs.h"
#include "sim/model/model.h"
#include "sim/model/state.h"

namespace supple {

struct OpenWorkspace;

struct Energies {
  double kinetic = 0, elastic = 0, gravitational = 0;  // the last one against the rest shape [J]
  double springs = 0;                                  // energy of the springs of soft handles, and of seams [J]
  double gas = 0;                                      // energy of gas in closed surfaces, against the rest shape [J]
  double contact = 0;                                  // energy of all contacts' normal forces; not in the total [J]
  double total() const { return kinetic + elastic + gravitational + springs + gas; }
};
// Returns the energies without those of soft handles, seams, gas and contact, which stay 0. Evaluates all elements; the
// workspace must be prepared for the model.
Energies energies(const Model& model, const State& state, const Vec3& gravity, OpenWorkspace& workspace);

// Holds what a body has, and what it was given, since its film began [J].
struct EnergyBalance {
  double total = 0;
  // Holds the energy that came from handles, seams that close, contact, restitution, air and changed values; it is
  // negative where these took more than they gave.
  double put_in = 0;
  double from_nothing = 0;  // how far total - put_in is above its lowest value so far
  double held = 0;          // the largest sum of kinetic, elastic, springs' and gas' energy so far
  double worked = 0;        // all that was put in and all that was taken, each as positive
  double flowed = 0;        // elastic energy that was lost to flow (model/flow.h); it is missing in `total`

  // Returns what from_nothing is compared with.
  double exchanged() const { return held + worked; }
};

// Follows a body step by step. Damping and backward Euler itself take energy; nothing but what holds, pushes or changes
// the body from outside may give any.
class EnergyBudget {
 public:
  // Begins with a state, before the next frame changes anything. Of the inputs, only gravity and gas are read. balance:
  // the balance at this state.
  void start(const Model& model, const StepInputs& inputs, const State& state, OpenWorkspace& workspace,
             const EnergyBalance& balance = {});
  // Counts the energy of soft handles' springs and of seams before the first step, by the targets and openings at that
  // time; later steps find by themselves how far these have moved. Does nothing where this energy is known.
  void know_springs(const Model& model, const Positions& targets, const std::vector<SeamOpening>& seams,
                    const State& state);
  bool knows_springs() const { return knows_springs_; }
  // Counts the energy of changes since the last step. Must be called when the inputs of the next step are there.
  void before_step(const Model& model, const StepInputs& inputs, const State& state, OpenWorkspace& workspace);
  // Counts a step that succeeded. The workspace must be as the step left it. q: the positions before the step.
  void after_step(const Model& model, const StepInputs& inputs, const Positions& q, const State& state,
                  OpenWorkspace& workspace);

  // Counts a step that was made with another energy: all energy that it changed counts as put in from outside.
  void after_untangling(const Model& model, const StepInputs& inputs, const State& state, OpenWorkspace& workspace);

  const EnergyBalance& balance() const { return balance_; }
  const Energies& energies() const { return parts_; }

 private:
  void add_to_budget(double work);
  // Counts the energy that restitution gave since the last call.
  void count_bounces(const State& state);
  void sum_up();

  Energies parts_;
  Positions seam_gaps_;  // of the model's seams at the end of the last step (model/seams.h) [m]
  EnergyBalance balance_;
  double lowest_ = 0;         // the lowest total - put_in so far
  double known_flow_ = 0;     // Flow::lost when parts_ was computed
  double known_bounces_ = 0;  // Bounces::given when parts_ was computed
  std::uint64_t model_ = 0;
  bool knows_springs_ = false;  // whether parts_.springs is the present energy of springs and seams
};

}  // namespace supple
